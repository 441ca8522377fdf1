// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/predicates3.hpp>

#include "exact_sign.hpp"

#include <algorithm>
#include <array>

namespace lagrain::detail {

namespace {

using Coordinate = double Site3::*;
/// The axes that stay when one looks along the third.
constexpr std::array<std::array<Coordinate, 2>, 3> kShadows{
    {{&Site3::x, &Site3::y}, {&Site3::y, &Site3::z}, {&Site3::z, &Site3::x}}};

template <class T>
T minor(const T& px, const T& py, const T& qx, const T& qy) {
  return px * qy - qx * py;
}

// Each formula once, for any number type; see exact_sign.
struct Orientation {
  template <class T>
  static T of(const Site3& a, const Site3& b, const Site3& c, const Site3& d) {
    const T bx = T(b.x) - T(a.x), by = T(b.y) - T(a.y), bz = T(b.z) - T(a.z);
    const T cx = T(c.x) - T(a.x), cy = T(c.y) - T(a.y), cz = T(c.z) - T(a.z);
    const T dx = T(d.x) - T(a.x), dy = T(d.y) - T(a.y), dz = T(d.z) - T(a.z);
    return bx * minor(cy, cz, dy, dz) - by * minor(cx, cz, dx, dz) + bz * minor(cx, cy, dx, dy);
  }
};

/// Of the shadows of three sites along the axis that is not named.
struct OrientationInPlane {
  template <class T>
  static T of(const Site3& a, const Site3& b, const Site3& c, Coordinate u, Coordinate v) {
    return minor(T(b.*u) - T(a.*u), T(b.*v) - T(a.*v), T(c.*u) - T(a.*u), T(c.*v) - T(a.*v));
  }
};

/// A site relative to another: place and height.
template <class T>
struct Lifted {
  T x, y, z, h;

  Lifted(const Site3& a, const Site3& e)
      : x(T(a.x) - T(e.x)),
        y(T(a.y) - T(e.y)),
        z(T(a.z) - T(e.z)),
        h(x * x + y * y + z * z - (T(a.w) - T(e.w))) {}

  const T& along(Coordinate axis) const {
    return axis == &Site3::x ? x : axis == &Site3::y ? y : z;
  }
};

struct PowerSide {
  template <class T>
  static T of(const Site3& pa, const Site3& pb, const Site3& pc, const Site3& pd, const Site3& e) {
    const Lifted<T> a(pa, e), b(pb, e), c(pc, e), d(pd, e);
    const T ab = minor(a.x, a.y, b.x, b.y), ac = minor(a.x, a.y, c.x, c.y);
    const T ad = minor(a.x, a.y, d.x, d.y), bc = minor(b.x, b.y, c.x, c.y);
    const T bd = minor(b.x, b.y, d.x, d.y), cd = minor(c.x, c.y, d.x, d.y);
    return a.h * (b.z * cd - c.z * bd + d.z * bc) - b.h * (a.z * cd - c.z * ad + d.z * ac) +
           c.h * (a.z * bd - b.z * ad + d.z * ab) - d.h * (a.z * bc - b.z * ac + c.z * ab);
  }
};

/// The same for four sites in one plane, by their shadows.
struct PowerSideInPlane {
  template <class T>
  static T of(const Site3& pa, const Site3& pb, const Site3& pc, const Site3& d, Coordinate u,
              Coordinate v) {
    const Lifted<T> a(pa, d), b(pb, d), c(pc, d);
    const auto shadow = [&](const Lifted<T>& p, const Lifted<T>& q) {
      return minor(p.along(u), p.along(v), q.along(u), q.along(v));
    };
    return a.h * shadow(b, c) + b.h * shadow(c, a) + c.h * shadow(a, b);
  }
};

}  // namespace

int exact_orientation(const Site3& a, const Site3& b, const Site3& c, const Site3& d) {
  return exact_sign<Orientation>(a, b, c, d);
}

int exact_power_side(const Site3& a, const Site3& b, const Site3& c, const Site3& d,
                     const Site3& e) {
  return exact_sign<PowerSide>(a, b, c, d, e);
}

bool collinear(const Site3& a, const Site3& b, const Site3& c) {
  return std::all_of(kShadows.begin(), kShadows.end(), [&](const auto& axes) {
    return exact_sign<OrientationInPlane>(a, b, c, axes[0], axes[1]) == 0;
  });
}

/// F = h_e - (la h_a + lb h_b + lc h_c + ld h_d) with barycentric la, lb, lc, ld of e. F is zero,
/// so the first id whose dF/dh is not zero decides; e itself has +1.
bool tie_in_conflict(const Site3* sites, int a, int b, int c, int d, int e) {
  std::array<int, 5> order{a, b, c, d, e};
  std::sort(order.begin(), order.end());
  for (const int id : order) {
    if (id == e) return false;
    const int share = orientation(sites[id == a ? e : a], sites[id == b ? e : b],
                                  sites[id == c ? e : c], sites[id == d ? e : d]);
    if (share != 0) return share > 0;
  }
  return false;
}

/// In the plane of a, b, c, seen along an axis that does not make it a line.
bool conflict_in_plane(const Site3* sites, int a, int b, int c, int d) {
  for (const auto& [u, v] : kShadows) {
    const auto turn = [&, u = u, v = v](int i, int j, int k) {
      return exact_sign<OrientationInPlane>(sites[i], sites[j], sites[k], u, v);
    };
    const int whole = turn(a, b, c);
    if (whole == 0) continue;
    const int side =
        whole * exact_sign<PowerSideInPlane>(sites[a], sites[b], sites[c], sites[d], u, v);
    if (side != 0) return side > 0;
    std::array<int, 4> order{a, b, c, d};
    std::sort(order.begin(), order.end());
    for (const int id : order) {
      if (id == d) return false;
      const int share = whole * turn(id == a ? d : a, id == b ? d : b, id == c ? d : c);
      if (share != 0) return share > 0;
    }
  }
  return false;
}

}  // namespace lagrain::detail
