// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/numbers.hpp>
#include <lagrain/words.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>

namespace lagrain {
namespace {

/// Bytes of the UTF-8 character at the start of a text; 0 if none begins there. (Characters that
/// are coded with more bytes than they need are taken as they are: terminals replace them.)
std::size_t character_length(std::string_view text) {
  const auto first = static_cast<unsigned char>(text.front());
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xC2 ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
  if (length > text.size()) return 0;
  const bool continues = std::all_of(
      text.begin() + std::min<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(text.size())),
      text.begin() + static_cast<std::ptrdiff_t>(length),
      [](char c) { return (c & 0xC0) == 0x80; });
  return continues ? length : 0;
}

std::string escape(std::string_view character) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  const auto last = static_cast<unsigned char>(character.back());
  const std::string two{kDigits[last / 16], kDigits[last % 16]};
  return "\\u00" + two;
}

/// One character as a message shows it.
std::string visible(std::string_view character) {
  if (character == "\n") return "\\n";
  if (character == "\t") return "\\t";
  if (character == "\r") return "\\r";
  const auto first = static_cast<unsigned char>(character[0]);
  const auto second = static_cast<unsigned char>(character.size() > 1 ? character[1] : 0);
  // The second set of control characters, which terminals obey as well, is U+0080 to U+009F.
  const bool controls = first < 0x20 || first == 0x7F || (first == 0xC2 && second < 0xA0);
  return controls ? escape(character) : std::string(character);
}

/// Letters to insert, delete or replace to turn one word into the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

std::string in_small_letters(std::string_view text) {
  std::string small(text);
  for (char& c : small) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return small;
}

}  // namespace

std::string shortened(std::string_view text, std::size_t most) {
  std::string out;
  for (std::size_t count = 0; !text.empty(); ++count) {
    if (count == most) return out + "...";
    const std::size_t length = character_length(text);
    if (length == 0) {
      out += "\\x" + escape(text.substr(0, 1)).substr(4);
    } else {
      out += visible(text.substr(0, length));
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

std::string readable(std::string_view text) {
  return shortened(text, std::numeric_limits<std::size_t>::max());
}

std::string shown(std::string_view text) { return "\"" + shortened(text) + "\""; }

std::string nearest_word(std::string_view word, const std::vector<std::string>& known) {
  constexpr std::size_t kLongest = 60;  // nobody mistypes a longer one
  if (word.size() > kLongest) return {};
  const std::string meant = in_small_letters(word);
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, meant.size() / 3) + 1;
  for (const std::string& other : known) {
    if (other.size() > kLongest) continue;
    const std::size_t distance = edit_distance(meant, in_small_letters(other));
    if (distance < least && distance < std::max(meant.size(), other.size())) {
      least = distance;
      nearest = other;
    }
  }
  constexpr std::size_t kTelling = 4;  // letters: shorter words are in many
  if (!nearest.empty() || meant.size() < kTelling) return nearest;
  for (const std::string& other : known) {
    const std::string name = in_small_letters(other);
    if (name.size() < kTelling) continue;
    if (name.find(meant) != std::string::npos || meant.find(name) != std::string::npos) {
      return other;
    }
  }
  return {};
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
  const std::string nearest = nearest_word(word, known);
  return nearest.empty() ? "" : " (did you mean " + shown(nearest) + "?)";
}

std::string rounded_down(double value, int digits) {
  std::string text = rounded(value, digits);
  if (std::strtod(text.c_str(), nullptr) <= value) return text;
  return rounded(value - std::pow(10, std::floor(std::log10(value)) + 1 - digits), digits);
}

}  // namespace lagrain
