#pragma once
/// @file
/// What a neighbourhood is: whatever proposes the pairs that may touch.

#include <lagrain/vec.hpp>

#include <compare>
#include <concepts>
#include <vector>

namespace lagrain {

/// Two grains, i < j.
struct Pair {
  int i = 0;
  int j = 0;
  auto operator<=>(const Pair&) const = default;
};

/// Whether two grains are within reach: their gap is at most the sum of their margins [m]. Every
/// neighbourhood asks this one function, so that all of them propose the very same pairs.
template <int Dim>
bool within_reach(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                  const Eigen::VectorXd& margin, int i, int j) {
  const double reach = (radius[i] + margin[i]) + (radius[j] + margin[j]);
  return (x.col(i) - x.col(j)).squaredNorm() <= reach * reach;
}

/// Proposes pairs. `near_pairs` lists, in increasing order, exactly the pairs within reach at
/// centres x [m], for margins [m] that it may shrink (never enlarge) where it cannot promise more.
/// As long as no grain moves further than its margin from there, no other pair can touch.
template <class N, int Dim>
concept Neighbourhood = requires(N n, const Columns<Dim>& x, const Eigen::VectorXd& radius,
                                 Eigen::VectorXd& margin, std::vector<Pair>& pairs) {
  n.near_pairs(x, radius, margin, pairs);
  { n.name() } -> std::convertible_to<const char*>;
};

}  // namespace lagrain
