// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/numbers.hpp>

#include <array>
#include <charconv>
#include <cmath>

namespace lagrain {

std::string shortest(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  std::array<char, 32> buffer;
  const auto [end, failure] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), failure == std::errc{} ? end : buffer.data()};
}

std::string rounded(double value, int digits) {
  if (!std::isfinite(value)) return shortest(value);
  std::array<char, 64> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                    std::chars_format::general, digits);
  return {buffer.data(), result.ptr};
}

}  // namespace lagrain
