// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/numbers.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

namespace lagrain {

namespace {

/// A finite number, with so many digits after the point or as many as matter.
/// @param format  'f' or 'g', as printf knows them
std::string printed(double value, char format, int digits) {
  std::string text(512, '\0');  // the largest double has 309 digits before the point
#ifdef __cpp_lib_to_chars
  const auto as = format == 'f' ? std::chars_format::fixed : std::chars_format::general;
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value, as, digits);
  text.resize(static_cast<std::size_t>(result.ptr - text.data()));
#else
  // A library without to_chars for doubles writes the same, if nobody has chosen a locale.
  const char* pattern = format == 'f' ? "%.*f" : "%.*g";
  text.resize(
      static_cast<std::size_t>(std::snprintf(text.data(), text.size(), pattern, digits, value)));
#endif
  return text;
}

}  // namespace

std::string shortest(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
#ifdef __cpp_lib_to_chars
  std::array<char, 32> buffer;
  const auto [end, failure] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), failure == std::errc{} ? end : buffer.data()};
#else
  int digits = 1;
  while (std::strtod(printed(value, 'g', digits).c_str(), nullptr) != value) ++digits;
  return printed(value, 'g', digits);
#endif
}

std::string rounded(double value, int digits) {
  return std::isfinite(value) ? printed(value, 'g', digits) : shortest(value);
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return shortest(value);
  const std::string text = printed(value, 'f', decimals);
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  return is_zero && text[0] == '-' ? text.substr(1) : text;
}

std::string percent(double share, int digits) { return rounded(100 * share, digits) + " %"; }

std::string grouped(std::int64_t count) {
  std::string text = std::to_string(count);
  const std::ptrdiff_t first = count < 0 ? 1 : 0;
  for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > first; at -= 3) {
    text.insert(static_cast<std::size_t>(at), 1, ',');
  }
  return text;
}

}  // namespace lagrain
