// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Several numbers side by side, for one instruction to work on.
///
/// The laws of contact are written once, over a number type. With `double` they give one contact,
/// with `Lanes<W>` W contacts at once. Every lane does what `double` would do, operation by
/// operation (IEEE 754, nothing fused), so the answer has the same bits at every width.

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace lagrain {

/// One truth value per lane: what a comparison of lanes gives.
template <int W>
struct LaneMask {
  /// The compiler's vector of W integers.
  typedef long long Vector __attribute__((vector_size(W * sizeof(long long))));
  Vector v;  ///< 0 or -1

  LaneMask() = default;
  explicit LaneMask(const Vector& a) : v(a) {}  ///< from the compiler's vector
  /// Copying is not trivial on purpose, as in Lanes.
  /// @{
  LaneMask(const LaneMask& other) : v(other.v) {}
  LaneMask& operator=(const LaneMask& other) {
    v = other.v;
    return *this;
  }
  /// @}
};

/// W doubles that instructions work on at once.
template <int W>
struct Lanes {
  /// The compiler's vector of W doubles.
  typedef double Vector __attribute__((vector_size(W * sizeof(double))));
  static constexpr int kWidth = W;  ///< how many
  Vector v;                         ///< one number in each lane

  Lanes() = default;
  /// A number stands for itself in every lane.
  Lanes(double a) : v(Vector{} + a) {}       // NOLINT: on purpose without `explicit`
  explicit Lanes(const Vector& a) : v(a) {}  ///< from the compiler's vector
  /// Copying is not trivial on purpose: such objects travel through memory, so that code compiled
  /// for different instruction sets agrees on how to call.
  /// @{
  Lanes(const Lanes& other) : v(other.v) {}
  Lanes& operator=(const Lanes& other) {
    v = other.v;
    return *this;
  }
  /// @}

  /// Arithmetic and comparison, lane by lane.
  /// @{
  Lanes operator-() const { return Lanes(-v); }
  Lanes& operator+=(const Lanes& b) { return *this = *this + b; }
  Lanes& operator-=(const Lanes& b) { return *this = *this - b; }
  Lanes& operator*=(const Lanes& b) { return *this = *this * b; }
  Lanes& operator/=(const Lanes& b) { return *this = *this / b; }

  friend Lanes operator+(const Lanes& a, const Lanes& b) { return Lanes(a.v + b.v); }
  friend Lanes operator-(const Lanes& a, const Lanes& b) { return Lanes(a.v - b.v); }
  friend Lanes operator*(const Lanes& a, const Lanes& b) { return Lanes(a.v * b.v); }
  friend Lanes operator/(const Lanes& a, const Lanes& b) { return Lanes(a.v / b.v); }
  friend LaneMask<W> operator<(const Lanes& a, const Lanes& b) { return LaneMask<W>(a.v < b.v); }
  friend LaneMask<W> operator>(const Lanes& a, const Lanes& b) { return LaneMask<W>(a.v > b.v); }
  friend LaneMask<W> operator<=(const Lanes& a, const Lanes& b) { return LaneMask<W>(a.v <= b.v); }
  /// @}
};

// What the laws use besides arithmetic, for one number and for lanes.

/// The square root in every lane.
template <int W>
Lanes<W> sqrt(const Lanes<W>& a) {
  Lanes<W> root;
  for (int k = 0; k < W; ++k) root.v[k] = std::sqrt(a.v[k]);
  return root;
}

/// `yes` where the condition holds, else `no`.
/// @{
inline double select(bool condition, double yes, double no) { return condition ? yes : no; }
template <int W>
Lanes<W> select(const LaneMask<W>& condition, const Lanes<W>& yes, const Lanes<W>& no) {
  return Lanes<W>(condition.v ? yes.v : no.v);
}
/// @}
/// yes where the condition holds, else 0.
/// @{
inline double only_if(bool condition, double yes) { return condition ? yes : 0; }
template <int W>
Lanes<W> only_if(const LaneMask<W>& condition, const Lanes<W>& yes) {
  return select(condition, yes, Lanes<W>(0));
}
/// @}
/// Whether the condition holds in some lane.
/// @{
inline bool any(bool condition) { return condition; }
inline bool any(const LaneMask<2>& condition) { return (condition.v[0] | condition.v[1]) != 0; }
inline bool any(const LaneMask<4>& condition) {
  const LaneMask<4>::Vector& v = condition.v;
  return any(
      LaneMask<2>(__builtin_shufflevector(v, v, 0, 1) | __builtin_shufflevector(v, v, 2, 3)));
}
inline bool any(const LaneMask<8>& condition) {
  const LaneMask<8>::Vector& v = condition.v;
  return any(LaneMask<4>(__builtin_shufflevector(v, v, 0, 1, 2, 3) |
                         __builtin_shufflevector(v, v, 4, 5, 6, 7)));
}
/// @}
/// a where a > 0, else 0: never negative, and 0 for NaN.
template <class Real>
Real positive_part(const Real& a) {
  return only_if(a > Real(0), a);
}
/// The smaller of the two in every lane; b where they cannot be compared.
template <class Real>
Real smaller(const Real& a, const Real& b) {
  return select(a < b, a, b);
}
/// The larger of the two in every lane; a where they cannot be compared.
template <class Real>
Real larger(const Real& a, const Real& b) {
  return select(a < b, b, a);
}

/// Number of contacts that a number type stands for.
/// @{
template <class Real>
inline constexpr int kLanes = 1;
template <int W>
inline constexpr int kLanes<Lanes<W>> = W;
/// @}

/// The number in lane k: lane() reads it, set_lane() writes it.
/// @{
inline double lane(double a, int) { return a; }
inline bool lane(bool a, int) { return a; }
inline void set_lane(double& a, int, double value) { a = value; }
template <int W>
double lane(const Lanes<W>& a, int k) {
  return a.v[k];
}
template <int W>
bool lane(const LaneMask<W>& a, int k) {
  return a.v[k] != 0;
}
template <int W>
void set_lane(Lanes<W>& a, int k, double value) {
  a.v[k] = value;
}
/// @}
/// What condition(k) says, for each lane k.
template <class Real, class Condition>
auto mask_of(Condition&& condition) {
  if constexpr (kLanes<Real> == 1) {
    return static_cast<bool>(condition(0));
  } else {
    LaneMask<kLanes<Real>> mask;
    for (int k = 0; k < kLanes<Real>; ++k) mask.v[k] = condition(k) ? -1 : 0;
    return mask;
  }
}

}  // namespace lagrain

namespace Eigen {

template <int W>
struct NumTraits<lagrain::Lanes<W>> : GenericNumTraits<double> {
  using Real = lagrain::Lanes<W>;
  using NonInteger = lagrain::Lanes<W>;
  using Literal = double;
  using Nested = lagrain::Lanes<W>;
  enum { RequireInitialization = 0 };
};

template <int W, class Op>
struct ScalarBinaryOpTraits<double, lagrain::Lanes<W>, Op> {
  using ReturnType = lagrain::Lanes<W>;
};
template <int W, class Op>
struct ScalarBinaryOpTraits<lagrain::Lanes<W>, double, Op> {
  using ReturnType = lagrain::Lanes<W>;
};

namespace internal {

/// Lanes keep their own alignment in Eigen's arrays. By default Eigen asks for that of the widest
/// vectors that the compiler is told of, which may be less: an error for clang.
template <int W, int Size>
struct compute_default_alignment<lagrain::Lanes<W>, Size> {
  enum { value = 0 };
};

}  // namespace internal

}  // namespace Eigen
