// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Formulas of a page: written as in TeX, shown as MathML, which browsers know.

#include <string>
#include <string_view>

namespace lagrain::figures {

/// A formula as MathML. It may have letters, numbers, words in \text{...}, operators, the names pi,
/// cdot and max, \frac{}{}, \sqrt{}, and ^ and _ with one sign or a group in braces behind them.
/// @param block  on a line of its own
/// @throws SceneError: one sentence about what it cannot read
std::string mathml(std::string_view formula, bool block = false);

/// A text with every $...$ as MathML, and every $$...$$ as a formula on a line of its own.
/// @throws SceneError if a formula does not end, or cannot be read
std::string with_formulas(const std::string& text);

}  // namespace lagrain::figures
