// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What a neighbourhood is: whatever proposes the pairs that may touch.

#include <lagrain/vec.hpp>

#include <algorithm>
#include <array>
#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace lagrain {

/// Two grains, i < j.
struct Pair {
  int i = 0;  ///< the smaller number
  int j = 0;  ///< the larger number
  bool operator==(const Pair&) const = default;
  /// One comparison instead of two: tables of pairs are searched and sorted all the time.
  auto operator<=>(const Pair& other) const { return key() <=> other.key(); }

 private:
  std::int64_t key() const { return (std::int64_t{i} << 32) + j; }
};

/// Sorts pairs of numbers from 0 to n - 1, by counting: once by j, then by i.
inline void sort_pairs(std::vector<Pair>& pairs, int n) {
  std::vector<Pair> by_j(pairs.size());
  std::vector<std::size_t> next;
  const auto scatter = [&](const std::vector<Pair>& from, std::vector<Pair>& to, int Pair::*key) {
    next.assign(static_cast<std::size_t>(n) + 1, 0);
    for (const Pair& pair : from) ++next[static_cast<std::size_t>(pair.*key) + 1];
    for (std::size_t k = 1; k < next.size(); ++k) next[k] += next[k - 1];
    for (const Pair& pair : from) to[next[static_cast<std::size_t>(pair.*key)]++] = pair;
  };
  scatter(pairs, by_j, &Pair::j);
  scatter(by_j, pairs, &Pair::i);
}

/// Whether two grains are within reach: their gap is at most the sum of their margins [m]. Every
/// neighbourhood asks this one function, so that all of them propose the very same pairs.
/// @param reach_a  radius and margin [m]
template <int Dim>
bool within_reach(const Vec<Dim>& a, double reach_a, const Vec<Dim>& b, double reach_b) {
  const double reach = reach_a + reach_b;
  return (a - b).squaredNorm() <= reach * reach;
}
/// The same for grains i and j of arrays: centres and radii [m], margins [m].
template <int Dim>
bool within_reach(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                  const Eigen::VectorXd& margin, int i, int j) {
  return within_reach<Dim>(x.col(i), radius[i] + margin[i], x.col(j), radius[j] + margin[j]);
}

/// The movement that most grains share: the median of each component over a sample of the
/// columns of f(i), i in [0, n). Neighbourhoods measure displacements against it, because a
/// common drift (free fall, a shaken box) moves no grain against another. A few fast grains do
/// not change a median.
template <int Dim, class F>
Vec<Dim> common_drift(int n, F&& f) {
  constexpr int kSample = 101;
  const int count = std::min(n, kSample);
  Vec<Dim> drift = Vec<Dim>::Zero();
  std::array<double, kSample> values;
  for (int d = 0; d < Dim && count > 0; ++d) {
    for (int k = 0; k < count; ++k) {
      const auto i = static_cast<int>(static_cast<std::int64_t>(k) * n / count);
      values[static_cast<std::size_t>(k)] = f(i)[d];
    }
    std::nth_element(values.begin(), values.begin() + count / 2, values.begin() + count);
    drift[d] = values[static_cast<std::size_t>(count / 2)];
  }
  return drift;
}

/// Proposes pairs. `near_pairs` lists, in increasing order, exactly the pairs within reach at
/// centres x [m], for margins [m] that it may shrink (never enlarge) where it cannot promise more.
/// As long as no grain moves further than its margin from there, a drift common to all apart, no
/// other pair can touch. One that carries something from question to question has `forget()` as
/// well, for when the grains are numbered anew, and may have `exchange()`, for when some leave and
/// others come.
template <class N, int Dim>
concept Neighbourhood = requires(N n, const Columns<Dim>& x, const Eigen::VectorXd& radius,
                                 Eigen::VectorXd& margin, std::vector<Pair>& pairs) {
  n.near_pairs(x, radius, margin, pairs);
  { n.name() } -> std::convertible_to<const char*>;
};

/// Whether a neighbourhood keeps that promise. One that shows or measures what goes without says so
/// by a `keeps_promise()` of its own; audits leave its pairs alone.
template <class N>
bool keeps_promise(const N& neighbourhood) {
  if constexpr (requires { neighbourhood.keeps_promise(); }) return neighbourhood.keeps_promise();
  return true;
}

/// Where a grain is [m].
template <int Dim>
using PlaceOf = std::function<Vec<Dim>(int)>;

/// One that can also tell of a few grains, the strays: `pairs_of` lists candidates, in any order,
/// among them all pairs within reach that have an end in `strays`. Places are in the frame of the
/// last answer. The strays are centred where they are now, with margins [m] that it may shrink; it
/// may add others to them, whose margins it had to change. All others are where they were centred
/// last. False if it cannot tell without `near_pairs`.
template <class N, int Dim>
concept AmendableNeighbourhood = Neighbourhood<N, Dim> &&
    requires(N n, std::vector<int>& strays, const PlaceOf<Dim>& place,
             const Eigen::VectorXd& radius, Eigen::VectorXd& margin, std::vector<Pair>& pairs) {
  { n.pairs_of(strays, place, radius, margin, pairs) } -> std::same_as<bool>;
};

}  // namespace lagrain
