// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/units.hpp>
#include <lagrain/words.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>
#include <system_error>

namespace lagrain {
namespace {

/// A unit as factor 10^power x SI. Powers of ten are kept apart so that the value is scaled once.
struct NamedUnit {
  std::string_view name;
  Unit unit;
  int power;
  double factor;
  bool prefixes;
};

constexpr std::array<NamedUnit, 16> kUnits{{
    {"m", {1, 0, 0}, 0, 1, true},
    {"g", {0, 1, 0}, -3, 1, true},
    {"t", {0, 1, 0}, 3, 1, true},
    {"s", {0, 0, 1}, 0, 1, true},
    {"min", {0, 0, 1}, 0, 60, false},
    {"h", {0, 0, 1}, 0, 3600, false},
    {"Hz", {0, 0, -1}, 0, 1, true},
    {"N", {1, 1, -2}, 0, 1, true},
    {"Pa", {-1, 1, -2}, 0, 1, true},
    {"J", {2, 1, -2}, 0, 1, true},
    {"W", {2, 1, -3}, 0, 1, true},
    {"rad", {}, 0, 1, false},
    {"deg", {}, 0, std::numbers::pi / 180, false},
    {"rpm", {0, 0, -1}, 0, std::numbers::pi / 30, false},
    {"%", {}, -2, 1, false},
    {"1", {}, 0, 1, false},
}};

struct Prefix {
  std::string_view name;
  int power;
};

constexpr std::array<Prefix, 9> kPrefixes{{{"n", -9},
                                           {"u", -6},
                                           {"µ", -6},
                                           {"m", -3},
                                           {"c", -2},
                                           {"d", -1},
                                           {"k", 3},
                                           {"M", 6},
                                           {"G", 9}}};

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

NamedUnit look_up(std::string_view name) {
  for (const NamedUnit& unit : kUnits) {
    if (unit.name == name) return unit;
  }
  for (const Prefix& prefix : kPrefixes) {
    if (name.substr(0, prefix.name.size()) != prefix.name) continue;
    for (NamedUnit unit : kUnits) {
      if (unit.prefixes && unit.name == name.substr(prefix.name.size())) {
        unit.power += prefix.power;
        return unit;
      }
    }
  }
  throw std::invalid_argument("unknown unit " + shown(name));
}

/// The double nearest to the decimal number `digits` times 10^power: "0.7" and -2 give 0.007, which
/// 0.7 / 100 does not.
double scaled(std::string_view digits, int power) {
  const std::size_t e = std::min(digits.find_first_of("eE"), digits.size());
  if (e < digits.size()) {
    const std::size_t sign = digits[e + 1] == '+' ? 1 : 0;
    int exponent = 0;
    std::from_chars(digits.data() + e + 1 + sign, digits.data() + digits.size(), exponent);
    power += exponent;
  }
  const std::string text = std::string(digits.substr(0, e)) + "e" + std::to_string(power);
  double value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc{}) throw std::invalid_argument("too large or too small a number");
  return value;
}

}  // namespace

Quantity parse_quantity(std::string_view text) {
  text = trimmed(text);
  Quantity quantity;
  const auto [end, failure] =
      std::from_chars(text.data(), text.data() + text.size(), quantity.value);
  if (failure != std::errc{}) throw std::invalid_argument("no number");
  const std::string_view digits = text.substr(0, static_cast<std::size_t>(end - text.data()));
  std::string_view rest = trimmed(text.substr(digits.size()));

  int power = 0;
  double factor = 1;
  int sign = 1;
  while (!rest.empty()) {
    const auto length = std::min(rest.find_first_of("*/"), rest.size());
    std::string_view part = trimmed(rest.substr(0, length));
    int exponent = 1;
    if (const auto hat = part.find('^'); hat != std::string_view::npos) {
      const std::string_view raised = part.substr(hat + 1);
      const auto [stop, bad] =
          std::from_chars(raised.data(), raised.data() + raised.size(), exponent);
      if (bad != std::errc{} || stop != raised.data() + raised.size() || std::abs(exponent) > 9) {
        throw std::invalid_argument("unknown power " + shown(part));
      }
      part = part.substr(0, hat);
    }
    const NamedUnit unit = look_up(part);
    exponent *= sign;
    quantity.unit.metre += exponent * unit.unit.metre;
    quantity.unit.kilogram += exponent * unit.unit.kilogram;
    quantity.unit.second += exponent * unit.unit.second;
    power += exponent * unit.power;
    factor *= std::pow(unit.factor, exponent);
    if (length == rest.size()) break;
    sign = rest[length] == '/' ? -1 : 1;
    rest = trimmed(rest.substr(length + 1));
    if (rest.empty()) throw std::invalid_argument("the unit breaks off");
  }
  if (power != 0) quantity.value = scaled(digits, power);
  quantity.value *= factor;
  return quantity;
}

std::string to_string(Unit unit) {
  std::string above;
  std::string below;
  const auto add = [&](const char* name, int power) {
    if (power == 0) return;
    std::string& side = power > 0 ? above : below;
    side += power < 0 ? "/" : side.empty() ? "" : " ";
    side += name;
    if (std::abs(power) == 1) return;
    side += '^';
    side += std::to_string(std::abs(power));
  };
  // What has a name of its own is easier to read.
  if (unit == Unit{1, 1, -2}) return "N";
  if (unit == Unit{0, 1, -2}) return "N/m";
  if (unit == Unit{-1, 1, -2}) return "Pa";
  if (unit == Unit{2, 1, -2}) return "J";
  if (unit == Unit{0, 0, -1}) return "1/s";
  add("kg", unit.kilogram);
  add("m", unit.metre);
  add("s", unit.second);
  if (above.empty() && !below.empty()) above = "1";
  return above + below;
}

}  // namespace lagrain
