// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the predicates of dim2 and dim3: the sign of a polynomial in doubles, exactly.

// WebAssembly rounds to nearest alone. CGAL's intervals would try to change that in vain, and signs
// would be wrong without a word.
#if defined(__wasm__) && !defined(CGAL_ALWAYS_ROUND_TO_NEAREST)
#error "define CGAL_ALWAYS_ROUND_TO_NEAREST: here intervals cannot change the rounding mode"
#endif

#include <CGAL/Interval_nt.h>
#include <CGAL/config.h>
#ifdef CGAL_USE_GMP
#include <CGAL/Gmpzf.h>
#include <CGAL/Mpzf.h>
#else
#include <CGAL/MP_Float.h>
#endif

namespace lagrain::detail {

/// Multiprecision floats that know no rounding. Mpzf keeps its digits in place and takes a quarter
/// of the time, where CGAL offers it. MP_Float takes twenty times as long, but needs no library.
#ifdef CGAL_HAS_MPZF
using ExactNumber = CGAL::Mpzf;
#elif defined(CGAL_USE_GMP)
using ExactNumber = CGAL::Gmpzf;
#else
using ExactNumber = CGAL::MP_Float;
#endif

/// Sign of `Formula::of<T>(arguments...)`, where T is any number type made from a double.
///
/// Intervals decide most of what a floating-point filter leaves (exact lattices among it, whose
/// intervals are points), exact multiprecision floats the rest.
template <class Formula, class... Arguments>
int exact_sign(const Arguments&... arguments) {
  {
    const CGAL::Interval_nt_advanced::Protector round_upwards;
    const auto sign = CGAL::sign(Formula::template of<CGAL::Interval_nt_advanced>(arguments...));
    if (CGAL::is_certain(sign)) return static_cast<int>(CGAL::get_certain(sign));
  }
  return static_cast<int>(CGAL::sign(Formula::template of<ExactNumber>(arguments...)));
}

inline int compare(double a, double b) { return (a > b) - (a < b); }

}  // namespace lagrain::detail
