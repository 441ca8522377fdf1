// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Quantities as people write them: "8 mm", "2650 kg/m^3", "1e7 N/m". Inside everything is SI;
/// units are converted here and nowhere else.

#include <string>
#include <string_view>

namespace lagrain {

/// Powers of metre, kilogram and second. Angles are pure numbers.
struct Unit {
  int metre = 0;     ///< power of the metre
  int kilogram = 0;  ///< power of the kilogram
  int second = 0;    ///< power of the second
  bool operator==(const Unit&) const = default;
};

/// A number with its unit, converted to SI.
struct Quantity {
  double value = 0;  ///< in SI
  Unit unit;         ///< of the value
};

/// Reads a number and a unit: factors joined by `*` or `/`, each a unit with an SI prefix and a
/// power (m g t s min h Hz N Pa J W rad deg rpm %). Without a unit it is a pure number.
/// Decimal units round once: "8 mm" is the double nearest to 0.008.
/// @throws std::invalid_argument with a short reason, such as: unknown unit "furlong"
Quantity parse_quantity(std::string_view text);

/// The SI unit in the order kg, m, s: "kg/m^3"; empty for a pure number.
std::string to_string(Unit unit);

}  // namespace lagrain
