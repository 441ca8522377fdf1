// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/predicates2.hpp>

#include "exact_sign.hpp"

#include <algorithm>
#include <array>

namespace lagrain::detail {

namespace {

// Each formula once, for any number type; see exact_sign.
struct Orientation {
  template <class T>
  static T of(const Site2& a, const Site2& b, const Site2& c) {
    return (T(a.x) - T(c.x)) * (T(b.y) - T(c.y)) - (T(a.y) - T(c.y)) * (T(b.x) - T(c.x));
  }
};

template <class T>
T lifted(const Site2& a, const T& x, const T& y, const Site2& d) {
  return x * x + y * y - (T(a.w) - T(d.w));
}

struct PowerSide {
  template <class T>
  static T of(const Site2& a, const Site2& b, const Site2& c, const Site2& d) {
    const T ax = T(a.x) - T(d.x), ay = T(a.y) - T(d.y);
    const T bx = T(b.x) - T(d.x), by = T(b.y) - T(d.y);
    const T cx = T(c.x) - T(d.x), cy = T(c.y) - T(d.y);
    return lifted(a, ax, ay, d) * (bx * cy - by * cx) + lifted(b, bx, by, d) * (cx * ay - cy * ax) +
           lifted(c, cx, cy, d) * (ax * by - ay * bx);
  }
};

/// h_a t_b - h_b t_a with t the coordinate along the line.
struct PowerSideOnLine {
  template <class T>
  static T of(const Site2& a, const Site2& b, const Site2& d) {
    const T ax = T(a.x) - T(d.x), ay = T(a.y) - T(d.y);
    const T bx = T(b.x) - T(d.x), by = T(b.y) - T(d.y);
    const bool along_x = a.x != b.x;
    return lifted(a, ax, ay, d) * (along_x ? bx : by) - lifted(b, bx, by, d) * (along_x ? ax : ay);
  }
};

}  // namespace

int exact_orientation(const Site2& a, const Site2& b, const Site2& c) {
  return exact_sign<Orientation>(a, b, c);
}

int exact_power_side(const Site2& a, const Site2& b, const Site2& c, const Site2& d) {
  return exact_sign<PowerSide>(a, b, c, d);
}

int exact_power_side_on_line(const Site2& a, const Site2& b, const Site2& d) {
  return exact_sign<PowerSideOnLine>(a, b, d);
}

/// F = h_d - (la h_a + lb h_b + lc h_c) with barycentric la, lb, lc of d. F is zero, so the first
/// id whose dF/dh is not zero decides; d itself has +1.
bool tie_in_conflict(const Site2* sites, int a, int b, int c, int d) {
  std::array<int, 4> order{a, b, c, d};
  std::sort(order.begin(), order.end());
  for (const int id : order) {
    if (id == d) return false;
    const int share =
        orientation(sites[id == a ? d : a], sites[id == b ? d : b], sites[id == c ? d : c]);
    if (share != 0) return share > 0;
  }
  return false;
}

/// The same along a line: la = t_b / (t_b - t_a), lb = -t_a / (t_b - t_a), t relative to d.
bool conflict_on_line(const Site2* sites, int a, int b, int d) {
  const bool along_x = sites[a].x != sites[b].x;
  const auto place = [&](int id) { return along_x ? sites[id].x : sites[id].y; };
  const int forward = compare(place(b), place(a));
  const int side = exact_power_side_on_line(sites[a], sites[b], sites[d]) * forward;
  if (side != 0) return side > 0;
  std::array<int, 3> order{a, b, d};
  std::sort(order.begin(), order.end());
  for (const int id : order) {
    if (id == d) return false;
    const int share =
        (id == a ? compare(place(b), place(d)) : compare(place(d), place(a))) * forward;
    if (share != 0) return share > 0;
  }
  return false;
}

}  // namespace lagrain::detail
