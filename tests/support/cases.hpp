// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How many cases a property test runs: few by default, many with `tests/run --nightly`.

#include <cstdlib>

namespace lagrain::test {

/// True under `tests/run --nightly`, which sets LAGRAIN_NIGHTLY.
inline bool nightly() {
  const char* value = std::getenv("LAGRAIN_NIGHTLY");
  return value != nullptr && *value != '\0';
}

/// `usual` seeds, steps or sizes by default, `many` in the nightly set.
inline int cases(int usual, int many) { return nightly() ? many : usual; }

}  // namespace lagrain::test
