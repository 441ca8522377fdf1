// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Numbers as text: for files that are read back, and for people.

#include <cstdint>
#include <string>

namespace lagrain {

/// The shortest decimal that reads back as the same double; "nan", "inf" and "-inf" as TOML and CSV
/// know them.
std::string shortest(double value);

/// Significant digits for people: "1.23e-05", "0.0123", "12.3".
std::string rounded(double value, int digits = 3);

/// A fixed number of decimals: "12.30", "-0.00" as "0.00".
std::string fixed(double value, int decimals);

/// A share with significant digits, as so many hundredths: "12 %".
std::string percent(double share, int digits = 2);

/// A count with commas between the thousands: "12,345".
std::string grouped(std::int64_t count);

}  // namespace lagrain
