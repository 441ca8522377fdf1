// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the predicates of dim2 and dim3: the sign of a polynomial in doubles, exactly.

#include <CGAL/Gmpzf.h>
#include <CGAL/Interval_nt.h>
#include <CGAL/Mpzf.h>

namespace lagrain::detail {

/// Multiprecision floats that know no rounding. Mpzf keeps its digits in place and takes a quarter
/// of the time, where CGAL offers it.
#ifdef CGAL_HAS_MPZF
using ExactNumber = CGAL::Mpzf;
#else
using ExactNumber = CGAL::Gmpzf;
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
