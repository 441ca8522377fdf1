// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Reading comma-separated values row by row.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lagrain {

/// A text without blanks around it.
inline std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// A title of a column, "name[unit]", in its two parts; the unit may be left out.
inline std::pair<std::string_view, std::string_view> name_and_unit(std::string_view title) {
  const std::size_t bracket = title.find('[');
  if (bracket == std::string_view::npos || title.back() != ']') return {title, {}};
  return {trimmed(title.substr(0, bracket)), title.substr(bracket + 1, title.size() - bracket - 2)};
}

/// The rows of a text of comma-separated values (RFC 4180: a cell may stand in quotes, a quote
/// within it is doubled). Empty lines are passed over.
class CsvRows {
 public:
  /// @param text  has to live as long as the rows are read
  explicit CsvRows(std::string_view text) : text_(text) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
  }

  /// Goes to the next row.
  /// @return whether there is one
  bool next() {
    cells_.clear();
    unquoted_.clear();
    while (at_ < text_.size()) {
      line_ = next_line_;
      while (read_cell()) {
      }
      if (cells_.size() > 1 || !cells_.front().empty()) return true;
      cells_.clear();
    }
    return false;
  }
  /// The cells of this row, without blanks around them; they hold until the next one.
  const std::vector<std::string_view>& cells() const { return cells_; }
  /// Where this row begins, from 1.
  std::int64_t line() const { return line_; }

 private:
  /// Reads a cell and the comma or the end of line behind it.
  /// @return whether there was a comma
  bool read_cell() {
    std::string_view cell;
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
    if (at_ < text_.size() && text_[at_] == '"') {
      ++at_;
      cell = rest_of_quoted();
    }
    std::size_t end = at_;
    while (end < text_.size() && text_[end] != ',' && text_[end] != '\n') ++end;
    if (cell.data() == nullptr) {
      cell = text_.substr(at_, end - at_);
      if (!cell.empty() && cell.back() == '\r') cell.remove_suffix(1);
      cell = trimmed(cell);
    }
    cells_.push_back(cell);
    at_ = end + 1;
    if (end < text_.size() && text_[end] == ',') return true;
    ++next_line_;
    return false;
  }

  std::string_view rest_of_quoted() {
    const std::size_t begin = at_;
    std::string* copy = nullptr;  // is made at the first doubled quote
    for (;;) {
      const std::size_t quote = std::min(text_.find('"', at_), text_.size());
      const std::string_view part = text_.substr(at_, quote - at_);
      next_line_ += std::count(part.begin(), part.end(), '\n');
      const bool doubled = quote + 1 < text_.size() && text_[quote + 1] == '"';
      if (doubled && copy == nullptr) copy = &unquoted_.emplace_back();
      if (copy != nullptr) *copy += part;
      at_ = std::min(quote + 1, text_.size());
      if (!doubled) {
        return copy != nullptr ? std::string_view(*copy) : text_.substr(begin, quote - begin);
      }
      *copy += '"';
      ++at_;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::int64_t line_ = 0;
  std::int64_t next_line_ = 1;
  std::vector<std::string_view> cells_;
  std::deque<std::string> unquoted_;  // cells that are no part of the text; they do not move
};

}  // namespace lagrain
