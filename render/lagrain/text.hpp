// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Size of a line of text, for layouts. The markup of a label is a small part of TeX's:
///
/// * outside dollars text is upright and literal; `\$` is a dollar, `\\` a backslash;
/// * between dollars letters are italic, digits and signs upright, spaces are ignored;
///   `_` and `^` take one character or a group `{...}`; `-` is a minus sign;
/// * `\mathrm{...}` is upright, `\,` a thin space; Greek letters and common signs have TeX's names
///   (`\mu`, `\Delta`, `\times`, `\cdot`, `\pm`, `\le`, `\ge`, `\approx`, `\sim`, `\to`, `\infty`,
///   `\partial`, `\propto`, `\ne`, `\in`, `\circ`, `\prime`, `\ldots`).
///
/// Example: `force $f_{ij}$ [N m$^{-1}$]`. Text is UTF-8. There is no kerning and no hinting.

#include <lagrain/display_list.hpp>

#include <string>

namespace lagrain {

/// Height of a capital letter as a fraction of the text size [-], Latin Modern Roman.
inline constexpr double kCapHeight = 0.683;

/// Extents of a line of text set at the origin, baseline on the x axis.
struct TextExtents {
  double advance = 0;  ///< where the next text would start [pt]
  Box ink;             ///< contains every mark; may reach left of 0 or beyond the advance [pt]
};

/// Measures a line in markup at a size [pt].
/// @throws ContractError that quotes the text if the markup is wrong or a character has no glyph
/// @throws SceneError if a font file cannot be read
TextExtents text_extents(const std::string& text, double size);

/// Box on the page that contains every mark of the label [pt].
Box label_box(const Label& label);

}  // namespace lagrain
