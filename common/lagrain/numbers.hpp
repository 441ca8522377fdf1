// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Numbers as text: for files that are read back, and for people.

#include <string>

namespace lagrain {

/// The shortest decimal that reads back as the same double; "nan", "inf" and "-inf" as TOML and CSV
/// know them.
std::string shortest(double value);

/// Significant digits for people: "1.23e-05", "0.0123", "12.3".
std::string rounded(double value, int digits = 3);

}  // namespace lagrain
