// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Comma-separated values: the first line names the columns as name[unit], and numbers read back
/// as the same doubles.

#include <lagrain/numbers.hpp>

#include <Eigen/Core>

#include <cmath>
#include <concepts>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace lagrain {

/// Rows of comma-separated values, cell by cell or whole.
class Csv {
 public:
  Csv() = default;
  /// @param head  the first line: "step[s],error[-]"
  explicit Csv(std::string_view head) : text_(head) { text_ += '\n'; }

  /// A whole row of numbers and texts.
  template <class... Cells>
  void row(const Cells&... cells) {
    (add(cells), ...);
    end();
  }

  /// A number that is none leaves its cell empty.
  /// @{
  void number(std::floating_point auto value) { cell(std::isnan(value) ? "" : shortest(value)); }
  void number(std::integral auto value) { cell(std::to_string(value)); }
  /// @}
  /// Puts text in quotes where it has to be.
  void word(std::string_view text) {
    if (text.find_first_of(",\"\n\r") == std::string_view::npos) {
      cell(text);
      return;
    }
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    cell(quoted + "\"");
  }
  /// The components of a vector, each in a column.
  template <class V>
  void vector(const V& v) {
    for (Eigen::Index d = 0; d < v.size(); ++d) number(v[d]);
  }
  /// Names of a vector's columns: stem + x, y, z.
  void names(int dimension, const std::string& stem, const std::string& unit) {
    for (int d = 0; d < dimension; ++d) word(stem + "xyz"[d] + "[" + unit + "]");
  }
  /// Ends a row that was written cell by cell.
  void end() {
    text_ += '\n';
    first_ = true;
  }

  const std::string& text() const { return text_; }  ///< all rows so far
  /// Gives the rows away and begins again.
  std::string take() { return std::exchange(text_, {}); }

 private:
  template <class Cell>
  void add(const Cell& value) {
    if constexpr (std::is_arithmetic_v<Cell>) {
      number(value);
    } else {
      word(value);
    }
  }
  void cell(std::string_view text) {
    if (!first_) text_ += ',';
    first_ = false;
    text_ += text;
  }

  std::string text_;
  bool first_ = true;
};

}  // namespace lagrain
