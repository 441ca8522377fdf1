// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How grains lie in memory while they are stepped: what a contact reads of a grain is one record,
/// what it writes is another, so that a contact touches as few cache lines as possible.

#include <lagrain/lanes.hpp>
#include <lagrain/needs.hpp>
#include <lagrain/touch.hpp>
#include <lagrain/vec.hpp>

#include <array>
#include <cstddef>
#include <type_traits>

namespace lagrain {

/// The least multiple of four that is not below `count`: so many doubles can be read by fours.
constexpr int padded_to_four(int count) { return (count + 3) / 4 * 4; }

/// The alignment [bytes] of a record of so many doubles, such that records in a row share as few
/// cache lines as they can: the largest power of two that divides its size, up to a line.
constexpr std::size_t record_alignment(int doubles) {
  std::size_t alignment = 64;
  while (static_cast<std::size_t>(doubles) * sizeof(double) % alignment != 0) alignment /= 2;
  return alignment;
}

/// What contacts read of a grain, as one row of numbers. The constants are their places in it.
template <int Dim, Needs needs>
struct GrainRecord {
  /// The place of a quantity in the row; kSize is the row's length.
  /// @{
  static constexpr int kPosition = 0;
  static constexpr int kRadius = Dim;
  static constexpr int kVelocity = Dim + 1;
  static constexpr int kInverseMass = 2 * Dim + 1;
  static constexpr int kOmega = 2 * Dim + 2;
  static constexpr int kInverseInertia = kOmega + kSpinDim<Dim>;
  static constexpr int kSize = needs.spin ? padded_to_four(kInverseInertia + 1) : kOmega;
  /// @}

  alignas(record_alignment(kSize)) std::array<double, kSize> at{};  ///< the row

  /// The quantity in its place: position [m], velocity [m/s], omega [rad/s], radius [m].
  /// @{
  Eigen::Map<Vec<Dim>> position() { return Eigen::Map<Vec<Dim>>(&at[kPosition]); }
  Eigen::Map<const Vec<Dim>> position() const { return Eigen::Map<const Vec<Dim>>(&at[kPosition]); }
  Eigen::Map<Vec<Dim>> velocity() { return Eigen::Map<Vec<Dim>>(&at[kVelocity]); }
  Eigen::Map<const Vec<Dim>> velocity() const { return Eigen::Map<const Vec<Dim>>(&at[kVelocity]); }
  Eigen::Map<SpinVec<Dim>> omega() { return Eigen::Map<SpinVec<Dim>>(&at[kOmega]); }
  Eigen::Map<const SpinVec<Dim>> omega() const {
    return Eigen::Map<const SpinVec<Dim>>(&at[kOmega]);
  }
  double radius() const { return at[kRadius]; }
  /// @}
};

/// What contacts write: the force and torque on a grain. Its mass fills a gap.
template <int Dim, Needs needs>
struct LoadRecord {
  /// The place of a quantity in the row; kSize is the row's length.
  /// @{
  static constexpr int kForce = 0;
  static constexpr int kMass = Dim;
  static constexpr int kTorque = Dim + 1;
  static constexpr int kSize = padded_to_four(kTorque + (needs.spin ? kSpinDim<Dim> : 0));
  /// @}

  alignas(record_alignment(kSize)) std::array<double, kSize> at{};  ///< the row

  /// The quantity in its place: force [N], torque [N m].
  /// @{
  Eigen::Map<Vec<Dim>> force() { return Eigen::Map<Vec<Dim>>(&at[kForce]); }
  Eigen::Map<const Vec<Dim>> force() const { return Eigen::Map<const Vec<Dim>>(&at[kForce]); }
  Eigen::Map<SpinVec<Dim>> torque() { return Eigen::Map<SpinVec<Dim>>(&at[kTorque]); }
  Eigen::Map<const SpinVec<Dim>> torque() const {
    return Eigen::Map<const SpinVec<Dim>>(&at[kTorque]);
  }
  /// @}
};

/// Asks for a record that contacts will read in no good order, before they wait for memory.
template <class Record>
void fetch_ahead(const Record& record) {
  constexpr std::size_t kLine = 64;
  const char* bytes = reinterpret_cast<const char*>(&record);
  for (std::size_t k = 0; k < sizeof(Record); k += kLine) __builtin_prefetch(bytes + k);
}

/// Bytes that a step reads and writes of one grain in this model: its records, and where the near
/// list saw it last. Several materials add one byte.
template <int Dim, Needs needs>
constexpr std::size_t bytes_per_grain() {
  return sizeof(GrainRecord<Dim, needs>) + sizeof(LoadRecord<Dim, needs>) +
         sizeof(double) * (Dim + 1);
}

namespace detail {

inline void read(double& value, const double* from) { value = *from; }
inline void write(double* to, double value) { *to = value; }
template <int W>
void read(Lanes<W>& value, const double* from) {
  __builtin_memcpy(&value.v, from, sizeof value.v);
}
template <int W>
void write(double* to, const Lanes<W>& value) {
  __builtin_memcpy(to, &value.v, sizeof value.v);
}

using Four = Lanes<4>::Vector;
using Eight = Lanes<8>::Vector;

/// Four rows of four numbers into columns, or back.
inline void transpose(Four& a, Four& b, Four& c, Four& d) {
  const Four ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Four ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Four cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Four cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}
/// Four rows of four numbers into columns, in the lower and in the upper half at once.
inline void transpose(Eight& a, Eight& b, Eight& c, Eight& d) {
  const Eight ab_even = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
  const Eight ab_odd = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
  const Eight cd_even = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
  const Eight cd_odd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 8, 9, 4, 5, 12, 13);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 8, 9, 4, 5, 12, 13);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 10, 11, 6, 7, 14, 15);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// Reads number c of each row, for c in [0, N): column[c] has one lane per row. It reads by fours;
/// the last four may overlap those before.
template <int N>
void read_columns(const std::array<const double*, 1>& row, std::array<double, N>& column) {
  for (std::size_t c = 0; c < N; ++c) column[c] = row[0][c];
}
template <int N>
void read_columns(const std::array<const double*, 4>& row, std::array<Lanes<4>, N>& column) {
  for (std::size_t block = 0; block < N; block += 4) {
    const std::size_t c = block + 4 <= N ? block : N - 4;
    std::array<Lanes<4>, 4> t;
    for (std::size_t r = 0; r < 4; ++r) read(t[r], row[r] + c);
    transpose(t[0].v, t[1].v, t[2].v, t[3].v);
    for (std::size_t r = 0; r < 4; ++r) column[c + r] = t[r];
  }
}
template <int N>
void read_columns(const std::array<const double*, 8>& row, std::array<Lanes<8>, N>& column) {
  for (std::size_t block = 0; block < N; block += 4) {
    const std::size_t c = block + 4 <= N ? block : N - 4;
    std::array<Lanes<8>, 4> t;
    for (std::size_t r = 0; r < 4; ++r) {
      Lanes<4> low, high;
      read(low, row[r] + c);
      read(high, row[r + 4] + c);
      t[r].v = __builtin_shufflevector(low.v, high.v, 0, 1, 2, 3, 4, 5, 6, 7);
    }
    transpose(t[0].v, t[1].v, t[2].v, t[3].v);
    for (std::size_t r = 0; r < 4; ++r) column[c + r] = t[r];
  }
}

/// Four columns back into rows of four numbers.
template <class Real>
struct Rows;
template <>
struct Rows<double> {
  std::array<double, 4> row;
  explicit Rows(const std::array<double, 4>& column) : row(column) {}
  void add_to(double* to, std::size_t) const {
    for (std::size_t c = 0; c < 4; ++c) to[c] += row[c];
  }
  void subtract_from(double* to, std::size_t) const {
    for (std::size_t c = 0; c < 4; ++c) to[c] -= row[c];
  }
};
template <int W>
struct Rows<Lanes<W>> {
  Lanes<4> row[W];
  explicit Rows(const std::array<Lanes<4>, 4>& column) {
    for (std::size_t r = 0; r < 4; ++r) row[r] = column[r];
    transpose(row[0].v, row[1].v, row[2].v, row[3].v);
  }
  explicit Rows(const std::array<Lanes<8>, 4>& column) {
    std::array<Lanes<8>, 4> t = column;
    transpose(t[0].v, t[1].v, t[2].v, t[3].v);
    for (std::size_t r = 0; r < 4; ++r) {
      row[r].v = __builtin_shufflevector(t[r].v, t[r].v, 0, 1, 2, 3);
      row[r + 4].v = __builtin_shufflevector(t[r].v, t[r].v, 4, 5, 6, 7);
    }
  }
  void add_to(double* to, std::size_t k) const {
    Lanes<4> sum;
    read(sum, to);
    write(to, sum + row[k]);
  }
  void subtract_from(double* to, std::size_t k) const {
    Lanes<4> rest;
    read(rest, to);
    write(to, rest - row[k]);
  }
};

}  // namespace detail

/// Reads the bodies of several records, a lane each.
template <class Real, int Dim, Needs needs>
Body<Dim, needs, Real> read_bodies(const GrainRecord<Dim, needs>* records,
                                   const std::array<int, kLanes<Real>>& slot) {
  using R = GrainRecord<Dim, needs>;
  std::array<const double*, kLanes<Real>> row;
  for (std::size_t k = 0; k < row.size(); ++k) row[k] = records[slot[k]].at.data();
  std::array<Real, R::kSize> column;
  detail::read_columns<R::kSize>(row, column);
  Body<Dim, needs, Real> body;
  for (int d = 0; d < Dim; ++d) {
    body.position[d] = column[static_cast<std::size_t>(R::kPosition + d)];
    body.velocity[d] = column[static_cast<std::size_t>(R::kVelocity + d)];
  }
  body.radius = column[R::kRadius];
  body.inverse_mass = column[R::kInverseMass];
  if constexpr (needs.spin) {
    for (int d = 0; d < kSpinDim<Dim>; ++d) {
      body.omega[d] = column[static_cast<std::size_t>(R::kOmega + d)];
    }
  }
  return body;
}

}  // namespace lagrain
