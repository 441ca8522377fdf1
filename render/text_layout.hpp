// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Where every glyph of a label stands. One layout serves all painters. Private to render.

#include <lagrain/text.hpp>

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

struct FT_FaceRec_;

namespace lagrain::detail {

enum class Font { text, math };

/// A glyph with its origin relative to the start of the line, before the label's rotation.
struct PlacedGlyph {
  Font font;
  std::uint32_t index;  ///< in the font file
  Vec<2> at;            ///< [pt]
  double size;          ///< [pt]
  std::string text;     ///< what the glyph says, UTF-8; for text search in a PDF
};

struct TextLayout {
  std::vector<PlacedGlyph> glyphs;
  TextExtents extents;
};

TextLayout lay_out(const std::string& text, double size);

/// Start of the line on the page [pt], from the label's position and anchors.
Vec<2> line_start(const Label& label, const TextExtents& extents);

/// Coverage of a label by pixels, rows from bottom to top.
struct Mask {
  int x = 0, y = 0;  ///< pixel of the lower left corner, counted from the page's lower left corner
  int width = 0, height = 0;
  std::vector<std::uint8_t> coverage;  ///< width * height
};

/// Exact area coverage of the label's outlines.
/// @param scale pixels per point
Mask rasterise(const Label& label, double scale);

/// A face for Cairo alone, which changes the state of the faces it is given. It lives for ever.
FT_FaceRec_* cairo_face(Font font);

}  // namespace lagrain::detail
