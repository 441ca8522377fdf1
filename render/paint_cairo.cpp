// SPDX-License-Identifier: GPL-3.0-or-later
#include "paint_cairo.hpp"

#include "image_io.hpp"
#include "text_layout.hpp"

#include <lagrain/check.hpp>

#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <string>
#include <string_view>

namespace lagrain {
namespace {

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;

cairo_font_face_t* font_face(detail::Font font) {
  // The faces are never destroyed, like the FreeType faces beneath.
  static const std::array<cairo_font_face_t*, 2> faces = [] {
    const auto make = [](detail::Font f) {
      return cairo_ft_font_face_create_for_ft_face(detail::cairo_face(f), 0);
    };
    return std::array{make(detail::Font::text), make(detail::Font::math)};
  }();
  return faces[static_cast<std::size_t>(font)];
}

// Draws items in page coordinates with y down, as Cairo has it.
class Painter {
 public:
  Painter(cairo_t* cairo, const DisplayList& list, bool text_as_text)
      : cairo_(cairo), height_(list.height), text_as_text_(text_as_text) {
    cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
    cairo_font_options_t* options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cairo_, options);
    cairo_font_options_destroy(options);
    if (list.background.a > 0) {
      colour(list.background);
      cairo_paint(cairo_);
    }
    for (const Item& item : list.items) std::visit([this](const auto& it) { put(it); }, item);
    if (clips_ != 0) throw ContractError("DisplayList: a clip was pushed and not popped");
  }

 private:
  double down(double y) const { return height_ - y; }

  void colour(Colour c) {
    cairo_set_source_rgba(cairo_, c.r / 255.0, c.g / 255.0, c.b / 255.0, c.a / 255.0);
  }

  // Fills and strokes the current path.
  void paint(Colour fill, const Stroke& outline) {
    if (fill.a > 0) {
      colour(fill);
      cairo_fill_preserve(cairo_);
    }
    if (outline.width > 0 && outline.colour.a > 0) {
      colour(outline.colour);
      cairo_set_line_width(cairo_, outline.width);
      cairo_stroke_preserve(cairo_);
    }
    cairo_new_path(cairo_);
  }

  void path(const std::vector<Vec<2>>& points) {
    for (const Vec<2>& p : points) cairo_line_to(cairo_, p[0], down(p[1]));
    if (points.size() == 1) cairo_line_to(cairo_, points[0][0], down(points[0][1]));
  }

  void put(const Disc& disc) {
    if (!(disc.radius > 0)) return;
    const double width = std::min(disc.outline.width, disc.radius);
    cairo_new_sub_path(cairo_);
    cairo_arc(cairo_, disc.centre[0], down(disc.centre[1]), disc.radius - 0.5 * width, 0,
              2 * std::numbers::pi);
    cairo_close_path(cairo_);
    paint(disc.fill, {disc.outline.colour, width});
  }

  void put(const Segment& segment) {
    path({segment.a, segment.b});
    paint(kNoFill, segment.stroke);
  }

  void put(const Polygon& polygon) {
    LAGRAIN_EXPECTS(polygon.corners.size() >= 3, "Polygon: fewer than three corners");
    path(polygon.corners);
    cairo_close_path(cairo_);
    paint(polygon.fill, polygon.outline);
  }

  void put(const Polyline& line) {
    for (const std::vector<Vec<2>>& piece : dashed(line)) {
      cairo_new_sub_path(cairo_);
      path(piece);
    }
    paint(kNoFill, line.stroke);
  }

  void put(const Label& label) {
    const detail::TextLayout layout = detail::lay_out(label.text, label.size);
    const Vec<2> start = detail::line_start(label, layout.extents);
    colour(label.colour);
    cairo_save(cairo_);
    cairo_translate(cairo_, start[0], down(start[1]));
    cairo_rotate(cairo_, -label.angle);
    // Glyphs of one font and size that follow each other become one run: smaller files, and words
    // that a reader's search finds.
    const auto& glyphs = layout.glyphs;
    for (std::size_t first = 0, end = 0; first < glyphs.size(); first = end) {
      std::vector<cairo_glyph_t> run;
      std::vector<cairo_text_cluster_t> clusters;
      std::string text;
      for (; end < glyphs.size() && glyphs[end].font == glyphs[first].font &&
             glyphs[end].size == glyphs[first].size;
           ++end) {
        run.push_back({glyphs[end].index, glyphs[end].at[0], -glyphs[end].at[1]});
        clusters.push_back({static_cast<int>(glyphs[end].text.size()), 1});
        text += glyphs[end].text;
      }
      cairo_set_font_face(cairo_, font_face(glyphs[first].font));
      cairo_set_font_size(cairo_, glyphs[first].size);
      const auto count = static_cast<int>(run.size());
      if (text_as_text_) {
        cairo_show_text_glyphs(cairo_, text.data(), static_cast<int>(text.size()), run.data(),
                               count, clusters.data(), static_cast<int>(clusters.size()),
                               static_cast<cairo_text_cluster_flags_t>(0));
      } else {  // pixels: Cairo 1.16 would round glyphs to whole pixels
        cairo_glyph_path(cairo_, run.data(), count);
        cairo_fill(cairo_);
      }
      cairo_new_path(cairo_);  // showing text leaves a current point behind
    }
    cairo_restore(cairo_);
  }

  void put(const Picture& picture) {
    const Image& image = picture.image;
    const auto pixels =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    LAGRAIN_EXPECTS(image.width > 0 && image.height > 0 && image.rgba.size() == 4 * pixels,
                    "Picture: the number of bytes does not match the size");
    bool opaque = true;
    for (std::size_t k = 0; k < pixels && opaque; ++k) opaque = image.rgba[4 * k + 3] == 255;
    const Surface surface(
        cairo_image_surface_create(opaque ? CAIRO_FORMAT_RGB24 : CAIRO_FORMAT_ARGB32, image.width,
                                   image.height),
        cairo_surface_destroy);
    unsigned char* data = cairo_image_surface_get_data(surface.get());
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
    for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
      for (std::size_t x = 0; x < static_cast<std::size_t>(image.width); ++x) {
        const std::uint8_t* p =
            image.rgba.data() + 4 * (y * static_cast<std::size_t>(image.width) + x);
        const auto times = [&](int k) { return (p[k] * p[3] + 127U) / 255U; };
        const std::uint32_t word =
            std::uint32_t{p[3]} << 24 | times(0) << 16 | times(1) << 8 | times(2);
        std::memcpy(data + y * stride + 4 * x, &word, 4);
      }
    }
    cairo_surface_mark_dirty(surface.get());
    const Vec<2> size = picture.box.size();
    cairo_save(cairo_);
    cairo_translate(cairo_, picture.box.low[0], down(picture.box.high[1]));
    cairo_scale(cairo_, size[0] / image.width, size[1] / image.height);
    cairo_set_source_surface(cairo_, surface.get(), 0, 0);
    double pixel_x = 1, pixel_y = 1;
    cairo_user_to_device_distance(cairo_, &pixel_x, &pixel_y);
    cairo_pattern_set_filter(cairo_get_source(cairo_), text_as_text_ || std::abs(pixel_x) >= 1
                                                           ? CAIRO_FILTER_NEAREST
                                                           : CAIRO_FILTER_GOOD);
    cairo_rectangle(cairo_, 0, 0, image.width, image.height);
    cairo_fill(cairo_);
    cairo_restore(cairo_);
  }

  void put(const PushClip& clip) {
    cairo_save(cairo_);
    ++clips_;
    const Vec<2> size = clip.box.size();
    cairo_rectangle(cairo_, clip.box.low[0], down(clip.box.high[1]), size[0], size[1]);
    cairo_clip(cairo_);
  }

  void put(const PopClip&) {
    if (clips_ == 0) throw ContractError("DisplayList: a clip is popped that was not pushed");
    --clips_;
    cairo_restore(cairo_);
  }

  cairo_t* cairo_;
  double height_;
  bool text_as_text_;
  int clips_ = 0;
};

void paint(cairo_surface_t* surface, const DisplayList& list, double scale, bool text_as_text) {
  static std::mutex mutex;  // Cairo's FreeType faces are shared
  const std::lock_guard lock(mutex);
  const std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo(cairo_create(surface),
                                                                 cairo_destroy);
  cairo_scale(cairo.get(), scale, scale);
  Painter(cairo.get(), list, text_as_text);
  cairo_show_page(cairo.get());
  const cairo_status_t status = cairo_status(cairo.get());
  if (status != CAIRO_STATUS_SUCCESS) {
    throw SceneError(std::string("Cairo: ") + cairo_status_to_string(status));
  }
}

void expect_page(const DisplayList& list) {
  LAGRAIN_EXPECTS(list.width > 0 && list.height > 0, "DisplayList: a page of " +
                                                         std::to_string(list.width) + " x " +
                                                         std::to_string(list.height) + " pt");
}

cairo_status_t append(void* to, const unsigned char* bytes, unsigned count) {
  static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

// Cairo numbers what it draws through the life of the process and writes the numbers into SVG as
// names (since 1.18 as sources). Counting from one instead makes equal pictures equal files.
std::string renumbered(const std::string& svg) {
  std::map<std::string, std::string> names;
  std::string out;
  out.reserve(svg.size());
  for (std::size_t at = 0; at < svg.size();) {
    std::size_t end = at;
    for (const std::string_view word :
         {"\"surface", "\"image", "\"#image", "\"source-", "\"#source-"}) {
      if (svg.compare(at, word.size(), word) == 0) end = at + word.size();
    }
    std::size_t digits = end;
    while (digits < svg.size() && svg[digits] >= '0' && svg[digits] <= '9') ++digits;
    if (end == at || digits == end) {
      out += svg[at++];
      continue;
    }
    const std::string number = svg.substr(end, digits - end);
    const auto name = names.emplace(number, std::to_string(names.size() + 1)).first->second;
    out.append(svg, at, end - at).append(name);
    at = digits;
  }
  return out;
}

// The bytes of a surface, which are complete once it has been finished.
std::string finished(const Surface& surface, const std::string& bytes) {
  cairo_surface_finish(surface.get());
  const cairo_status_t status = cairo_surface_status(surface.get());
  if (status != CAIRO_STATUS_SUCCESS) {
    throw SceneError(std::string("Cairo: ") + cairo_status_to_string(status));
  }
  return bytes;
}

}  // namespace

namespace detail {

std::string encode_pdf(const DisplayList& list) {
  expect_page(list);
  std::string bytes;
  const Surface surface(
      cairo_pdf_surface_create_for_stream(append, &bytes, list.width, list.height),
      cairo_surface_destroy);
  // A fixed date: the same list gives the same bytes.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE,
                                 "2000-01-01T00:00:00Z");
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR, "lagrain");
  if (!list.title.empty()) {
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, list.title.c_str());
  }
  paint(surface.get(), list, 1, true);
  return finished(surface, bytes);
}

Image paint_rgba_cairo(const DisplayList& list, double dpi) {
  expect_page(list);
  Image image;
  image.width = std::max(1, static_cast<int>(std::lround(list.width * dpi / 72)));
  image.height = std::max(1, static_cast<int>(std::lround(list.height * dpi / 72)));
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, image.width, image.height),
                        cairo_surface_destroy);
  // The page's lower edge stays on the last row when its height is not a whole number of pixels.
  cairo_surface_set_device_offset(surface.get(), 0, image.height - list.height * dpi / 72);
  paint(surface.get(), list, dpi / 72, false);
  cairo_surface_flush(surface.get());
  const unsigned char* data = cairo_image_surface_get_data(surface.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    for (std::size_t x = 0; x < static_cast<std::size_t>(image.width); ++x) {
      std::uint32_t word = 0;
      std::memcpy(&word, data + y * stride + 4 * x, 4);
      const std::uint32_t alpha = word >> 24;
      for (const unsigned shift : {16U, 8U, 0U}) {
        const std::uint32_t value = word >> shift & 255U;
        image.rgba.push_back(static_cast<std::uint8_t>(
            alpha == 0 ? 0 : std::min(255U, (value * 255U + alpha / 2) / alpha)));
      }
      image.rgba.push_back(static_cast<std::uint8_t>(alpha));
    }
  }
  return image;
}

}  // namespace detail

void paint_pdf(const DisplayList& list, const std::filesystem::path& path) {
  detail::write_whole(path, detail::encode_pdf(list));
}

void paint_svg(const DisplayList& list, const std::filesystem::path& path) {
  expect_page(list);
  std::string bytes;
  const Surface surface(
      cairo_svg_surface_create_for_stream(append, &bytes, list.width, list.height),
      cairo_surface_destroy);
  paint(surface.get(), list, 1, true);
  detail::write_whole(path, renumbered(finished(surface, bytes)));
}

}  // namespace lagrain
