// SPDX-License-Identifier: GPL-3.0-or-later
#include "text_layout.hpp"

#include <lagrain/check.hpp>

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H
#include FT_BBOX_H

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

namespace lagrain {
namespace detail {
namespace {

// FreeType's objects are not thread-safe; every use of them holds this mutex.
std::mutex& font_mutex() {
  static std::mutex mutex;
  return mutex;
}

struct Fonts {
  FT_Library freetype = nullptr;
  std::array<FT_Face, 2> ours{}, cairos{};

  Fonts() {
    if (FT_Init_FreeType(&freetype) != 0) throw SceneError("FreeType could not be started");
    for (FT_Face& face : ours) face = open(&face == &ours[0]);
    for (FT_Face& face : cairos) face = open(&face == &cairos[0]);
  }

  FT_Face open(bool text) const {
    const char* path = text ? LAGRAIN_FONT_TEXT : LAGRAIN_FONT_MATH;
    FT_Face face = nullptr;
    if (FT_New_Face(freetype, path, 0, &face) != 0) {
      throw SceneError(std::string(path) +
                       ": the font cannot be read; it comes with Debian's package fonts-lmodern");
    }
    return face;
  }

  FT_Face face(Font font) const { return ours[static_cast<std::size_t>(font)]; }
};

// Never destroyed: Cairo keeps the faces in caches of its own until the process ends.
const Fonts& fonts() {
  static const Fonts* const all = new Fonts;
  return *all;
}

std::string utf8(char32_t c) {
  std::string out;
  const auto put = [&out](char32_t byte) { out += static_cast<char>(byte); };
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0 | c >> 6), put(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    put(0xE0 | c >> 12), put(0x80 | (c >> 6 & 0x3F)), put(0x80 | (c & 0x3F));
  } else {
    put(0xF0 | c >> 18), put(0x80 | (c >> 12 & 0x3F));
    put(0x80 | (c >> 6 & 0x3F)), put(0x80 | (c & 0x3F));
  }
  return out;
}

// Signs by their TeX names. Greek small letters are slanted, capitals upright, as in TeX.
const std::map<std::string, char32_t>& commands() {
  static const std::map<std::string, char32_t> table{{"alpha", 0x1D6FC},
                                                     {"beta", 0x1D6FD},
                                                     {"gamma", 0x1D6FE},
                                                     {"delta", 0x1D6FF},
                                                     {"varepsilon", 0x1D700},
                                                     {"zeta", 0x1D701},
                                                     {"eta", 0x1D702},
                                                     {"theta", 0x1D703},
                                                     {"iota", 0x1D704},
                                                     {"kappa", 0x1D705},
                                                     {"lambda", 0x1D706},
                                                     {"mu", 0x1D707},
                                                     {"nu", 0x1D708},
                                                     {"xi", 0x1D709},
                                                     {"pi", 0x1D70B},
                                                     {"rho", 0x1D70C},
                                                     {"sigma", 0x1D70E},
                                                     {"tau", 0x1D70F},
                                                     {"varphi", 0x1D711},
                                                     {"chi", 0x1D712},
                                                     {"psi", 0x1D713},
                                                     {"omega", 0x1D714},
                                                     {"partial", 0x1D715},
                                                     {"epsilon", 0x1D716},
                                                     {"phi", 0x1D719},
                                                     {"Gamma", 0x393},
                                                     {"Delta", 0x394},
                                                     {"Theta", 0x398},
                                                     {"Lambda", 0x39B},
                                                     {"Xi", 0x39E},
                                                     {"Pi", 0x3A0},
                                                     {"Sigma", 0x3A3},
                                                     {"Phi", 0x3A6},
                                                     {"Psi", 0x3A8},
                                                     {"Omega", 0x3A9},
                                                     {"times", 0xD7},
                                                     {"cdot", 0x22C5},
                                                     {"pm", 0xB1},
                                                     {"le", 0x2264},
                                                     {"ge", 0x2265},
                                                     {"approx", 0x2248},
                                                     {"sim", 0x223C},
                                                     {"to", 0x2192},
                                                     {"infty", 0x221E},
                                                     {"propto", 0x221D},
                                                     {"ne", 0x2260},
                                                     {"in", 0x2208},
                                                     {"circ", 0x2218},
                                                     {"prime", 0x2032},
                                                     {"ldots", 0x2026},
                                                     {"{", '{'},
                                                     {"}", '}'},
                                                     {"$", '$'},
                                                     {"%", '%'},
                                                     {"_", '_'},
                                                     {"\\", '\\'}};
  return table;
}

char32_t italic(char32_t c) {
  if (c == 'h') return 0x210E;  // Unicode's one hole: the Planck constant
  if (c >= 'a' && c <= 'z') return 0x1D44E + (c - 'a');
  if (c >= 'A' && c <= 'Z') return 0x1D434 + (c - 'A');
  if (c == '-') return 0x2212;
  return c;
}

// Space around signs as in TeX: thick around relations, medium around binary operators.
enum class Role { ordinary, relation, binary, opening, comma };
Role role(char32_t c) {
  switch (c) {
    case '=':
    case '<':
    case '>':
    case 0x2264:
    case 0x2265:
    case 0x2248:
    case 0x223C:
    case 0x2192:
    case 0x221D:
    case 0x2260:
    case 0x2208:
      return Role::relation;
    case '+':
    case 0x2212:
    case 0xD7:
    case 0x22C5:
    case 0xB1:
      return Role::binary;
    case '(':
    case '[':
    case '{':
      return Role::opening;
    case ',':
      return Role::comma;
    default:
      return Role::ordinary;
  }
}

// Fractions of the size of the nucleus, close to TeX's plain parameters for cmsy10.
constexpr double kScript = 0.7, kSubDrop = 0.15, kSubDropBelowSuper = 0.247, kSuperRise = 0.413;
constexpr double kScriptSpace = 0.05;

class Typesetter {
 public:
  Typesetter(const std::string& text, double size) : text_(text) {
    bool math = false;
    while (at_ < text_.size()) {
      if (peek() == '$') {
        ++at_;
        math = !math;
        before_ = Role::opening;
      } else if (math) {
        atom({size, 0, 0});
      } else {
        if (peek() == '\\') {
          ++at_;
          if (at_ == text_.size() || (peek() != '$' && peek() != '\\')) {
            fail("a backslash outside dollars stands only before $ or a backslash");
          }
        }
        put(next(), Font::text, {size, 0, 0});
      }
    }
    if (math) fail("a dollar is missing");
    layout_.extents.advance = x_;
    if (!inked_) layout_.extents.ink = {Vec<2>::Zero(), Vec<2>::Zero()};
  }

  TextLayout take() { return std::move(layout_); }

 private:
  struct Style {
    double size;  // [pt]
    double rise;  // of the baseline [pt]
    int depth;    // of scripts
  };

  [[noreturn]] void fail(const std::string& why) const {
    throw ContractError("label \"" + text_ + "\": " + why);
  }

  char peek() const { return text_[at_]; }

  char32_t next() {
    const auto byte = static_cast<unsigned char>(text_[at_++]);
    if (byte < 0x80) return byte;
    const int more = byte >= 0xF0 ? 3 : byte >= 0xE0 ? 2 : byte >= 0xC0 ? 1 : -1;
    if (more < 0) fail("the text is not UTF-8");
    char32_t c = byte & (0x3FU >> more);
    for (int k = 0; k < more; ++k) {
      if (at_ == text_.size() || (static_cast<unsigned char>(text_[at_]) & 0xC0) != 0x80) {
        fail("the text is not UTF-8");
      }
      c = c << 6 | (static_cast<unsigned char>(text_[at_++]) & 0x3F);
    }
    return c;
  }

  void put(char32_t c, Font font, const Style& style) {
    FT_UInt index = FT_Get_Char_Index(fonts().face(font), c);
    if (index == 0 && font == Font::text) {  // mathematical signs in plain text
      font = Font::math;
      index = FT_Get_Char_Index(fonts().face(font), c);
    }
    if (index == 0) fail("the fonts have no glyph for \"" + utf8(c) + "\"");
    const FT_Face face = fonts().face(font);
    if (FT_Load_Glyph(face, index, FT_LOAD_NO_SCALE) != 0) fail("a glyph cannot be read");

    const double unit = style.size / face->units_per_EM;
    const double advance = unit * static_cast<double>(face->glyph->advance.x);
    const Vec<2> origin(x_, style.rise);
    overhang_ = 0;
    if (face->glyph->outline.n_points > 0) {
      FT_BBox box;
      FT_Outline_Get_BBox(&face->glyph->outline, &box);
      const auto corner = [&](FT_Pos x, FT_Pos y) -> Vec<2> {
        return origin + unit * Vec<2>(static_cast<double>(x), static_cast<double>(y));
      };
      Box& ink = layout_.extents.ink;
      const Box mark{corner(box.xMin, box.yMin), corner(box.xMax, box.yMax)};
      ink.low = inked_ ? ink.low.cwiseMin(mark.low).eval() : mark.low;
      ink.high = inked_ ? ink.high.cwiseMax(mark.high).eval() : mark.high;
      inked_ = true;
      overhang_ = std::max(0.0, mark.high[0] - x_ - advance);
    }
    layout_.glyphs.push_back({font, index, origin, style.size, utf8(c)});
    x_ += advance;
  }

  void sign(char32_t c, const Style& style) {
    const Role r = role(c);
    const bool operand_before = before_ == Role::ordinary;
    const double em = style.depth == 0 && operand_before ? style.size / 18 : 0;
    const double space = r == Role::relation ? 5 * em : r == Role::binary ? 4 * em : 0;
    x_ += space;
    put(c, Font::math, style);
    if (r == Role::relation || r == Role::binary) overhang_ = 0;
    x_ += r == Role::comma ? 3 * em : space;
    before_ = r;
  }

  // `{...}` or a single atom, without scripts of its own.
  void nucleus(const Style& style) {
    if (at_ == text_.size() || peek() == '$') fail("something is missing after _ or ^");
    const char c = peek();
    if (c == '{') {
      ++at_;
      group(style);
    } else if (c == '}') {
      fail("a brace closes that was not opened");
    } else if (c == '\\') {
      command(style);
    } else {
      sign(italic(next()), style);
    }
  }

  void group(const Style& style) {
    before_ = Role::opening;
    while (true) {
      if (at_ == text_.size() || peek() == '$') fail("a brace is not closed");
      if (peek() == '}') break;
      atom(style);
    }
    ++at_;
    before_ = Role::ordinary;
  }

  void command(const Style& style) {
    ++at_;
    if (at_ == text_.size()) fail("a command has no name");
    std::string name(1, text_[at_++]);
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    if (letter(name[0])) {
      while (at_ < text_.size() && letter(peek())) name += text_[at_++];
    }
    if (name == ",") {
      x_ += style.size / 6;
    } else if (name == "mathrm") {
      if (at_ == text_.size() || peek() != '{') fail("\\mathrm needs a group in braces");
      ++at_;
      while (at_ < text_.size() && peek() != '}' && peek() != '$') put(next(), Font::text, style);
      if (at_ == text_.size() || peek() != '}') fail("a brace is not closed");
      ++at_;
      before_ = Role::ordinary;
    } else if (const auto found = commands().find(name); found != commands().end()) {
      sign(found->second, style);
    } else {
      fail("the command \\" + name + " is not known");
    }
  }

  void atom(const Style& style) {
    if (peek() == ' ') {
      ++at_;
      return;
    }
    overhang_ = 0;
    if (peek() != '_' && peek() != '^') nucleus(style);  // scripts alone: as in m$^2$
    if (at_ == text_.size() || (peek() != '_' && peek() != '^')) {
      x_ += overhang_;
      overhang_ = 0;
      return;
    }

    const std::size_t first = at_;
    const double start = x_, overhang = overhang_;
    double end = x_;
    const bool both = has_both_scripts();
    for (int scripts = 0; at_ < text_.size() && (peek() == '_' || peek() == '^'); ++scripts) {
      if (scripts == 2 || (scripts == 1 && text_[first] == peek())) fail("a script is repeated");
      const bool super = text_[at_++] == '^';
      x_ = super ? start + overhang : start;
      const double shift = super ? kSuperRise : both ? -kSubDropBelowSuper : -kSubDrop;
      nucleus({kScript * style.size, style.rise + shift * style.size, style.depth + 1});
      end = std::max(end, x_ + overhang_);
    }
    x_ = end + kScriptSpace * style.size;
    overhang_ = 0;
    before_ = Role::ordinary;
  }

  // Tells whether the other script follows the first one.
  bool has_both_scripts() const {
    std::size_t k = at_ + 1;
    if (k < text_.size() && text_[k] == '{') {
      for (int open = 0; k < text_.size(); ++k) {
        open += text_[k] == '{' ? 1 : text_[k] == '}' ? -1 : 0;
        if (open == 0) break;
      }
    } else if (k < text_.size() && text_[k] == '\\') {
      while (k + 1 < text_.size() && std::isalpha(static_cast<unsigned char>(text_[k + 1])) != 0)
        ++k;
    }
    return k + 1 < text_.size() && (text_[k + 1] == '_' || text_[k + 1] == '^');
  }

  const std::string& text_;
  std::size_t at_ = 0;
  double x_ = 0;
  double overhang_ = 0;  // of the last glyph beyond its advance: TeX's italic correction
  Role before_ = Role::opening;
  bool inked_ = false;
  TextLayout layout_;
};

Vec<2> turned(const Vec<2>& v, double angle) {
  return {std::cos(angle) * v[0] - std::sin(angle) * v[1],
          std::sin(angle) * v[0] + std::cos(angle) * v[1]};
}

}  // namespace

TextLayout lay_out(const std::string& text, double size) {
  LAGRAIN_EXPECTS(size > 0, "lay_out: size of text");
  const std::lock_guard lock(font_mutex());
  return Typesetter(text, size).take();
}

Vec<2> line_start(const Label& label, const TextExtents& extents) {
  const double left = label.across == Across::left     ? 0
                      : label.across == Across::centre ? -0.5 * extents.advance
                                                       : -extents.advance;
  const double down = label.along == Along::baseline ? 0
                      : label.along == Along::middle ? -0.5 * kCapHeight * label.size
                                                     : -kCapHeight * label.size;
  return label.at + turned({left, down}, label.angle);
}

Mask rasterise(const Label& label, double scale) {
  const TextLayout layout = lay_out(label.text, label.size);
  if (layout.glyphs.empty()) return {};
  const Vec<2> start = line_start(label, layout.extents);
  const Box box = label_box(label);

  Mask mask;
  // One pixel more on every side: outlines are rounded to 1/64 pixel.
  mask.x = static_cast<int>(std::floor(scale * box.low[0])) - 1;
  mask.y = static_cast<int>(std::floor(scale * box.low[1])) - 1;
  mask.width = static_cast<int>(std::ceil(scale * box.high[0])) + 1 - mask.x;
  mask.height = static_cast<int>(std::ceil(scale * box.high[1])) + 1 - mask.y;
  const auto size = static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height);
  mask.coverage.resize(size);

  const std::lock_guard lock(font_mutex());
  std::vector<std::uint8_t> one;
  for (const PlacedGlyph& glyph : layout.glyphs) {
    const FT_Face face = fonts().face(glyph.font);
    if (FT_Load_Glyph(face, glyph.index, FT_LOAD_NO_SCALE) != 0) continue;  // was read before
    FT_Outline& outline = face->glyph->outline;
    if (outline.n_points == 0) continue;
    const double unit = glyph.size / face->units_per_EM;
    for (int k = 0; k < outline.n_points; ++k) {
      FT_Vector& p = outline.points[k];
      const Vec<2> on_line =
          glyph.at + unit * Vec<2>(static_cast<double>(p.x), static_cast<double>(p.y));
      const Vec<2> pixel = scale * (start + turned(on_line, label.angle)) - Vec<2>(mask.x, mask.y);
      p.x = std::lround(64 * pixel[0]);
      p.y = std::lround(64 * pixel[1]);
    }
    one.assign(size, 0);
    FT_Bitmap bitmap{};
    bitmap.rows = static_cast<unsigned>(mask.height);
    bitmap.width = static_cast<unsigned>(mask.width);
    bitmap.pitch = -mask.width;  // rows from bottom to top
    bitmap.buffer = one.data();
    bitmap.num_grays = 256;
    bitmap.pixel_mode = FT_PIXEL_MODE_GRAY;
    if (FT_Outline_Get_Bitmap(fonts().freetype, &outline, &bitmap) != 0) {
      throw ContractError("label \"" + label.text + "\": FreeType cannot draw it at this size");
    }
    for (std::size_t k = 0; k < size; ++k) {
      mask.coverage[k] = static_cast<std::uint8_t>(std::min(255, mask.coverage[k] + one[k]));
    }
  }
  return mask;
}

FT_FaceRec_* cairo_face(Font font) {
  const std::lock_guard lock(font_mutex());
  return fonts().cairos[static_cast<std::size_t>(font)];
}

}  // namespace detail

TextExtents text_extents(const std::string& text, double size) {
  return detail::lay_out(text, size).extents;
}

Box label_box(const Label& label) {
  const TextExtents extents = text_extents(label.text, label.size);
  const Vec<2> start = detail::line_start(label, extents);
  Box box{start, start};
  bool first = true;
  for (const Vec<2>& corner : corners(extents.ink)) {
    const Vec<2> p = start + detail::turned(corner, label.angle);
    box.low = first ? p : box.low.cwiseMin(p).eval();
    box.high = first ? p : box.high.cwiseMax(p).eval();
    first = false;
  }
  return box;
}

}  // namespace lagrain
