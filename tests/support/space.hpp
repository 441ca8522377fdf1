// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// A dimension as a type, for cases that need no law.

namespace lagrain::test {

template <int D>
struct Space {
  static constexpr int Dim = D;
};

}  // namespace lagrain::test
