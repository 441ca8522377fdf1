// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What every dynamic regular triangulation offers, whatever its dimension. The modules dim2
/// and dim3 have one each; `common` only names the interface, so that the neighbourhood is
/// written once.

#include <lagrain/edge_list.hpp>
#include <lagrain/vec.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

namespace lagrain {

/// Sorts a list of sites or simplices, and leaves each of them once.
inline void sort_unique(std::vector<int>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// Regular (weighted Delaunay) triangulation of moving sites; specialised per dimension.
template <int Dim>
class Triangulation;

/// What an update had to do, rung by rung of the ladder. The counts of several updates add up.
struct UpdateReport {
  std::int64_t flips = 0;  ///< local flips
  /// Sites taken out before a move because a simplex would have inverted.
  std::int64_t extracted = 0;
  /// Places where flips could not finish: in the plane a site taken out, in space a cavity
  /// filled anew.
  std::int64_t unstuck = 0;
  /// Sites put back: those taken out, and those that were hidden and are visible now.
  std::int64_t reinserted = 0;
  std::int64_t rebuilds = 0;  ///< builds from nothing, the last rung

  /// Adds the counts of another update.
  UpdateReport& operator+=(const UpdateReport& other) {
    flips += other.flips;
    extracted += other.extracted;
    unstuck += other.unstuck;
    reinserted += other.reinserted;
    rebuilds += other.rebuilds;
    return *this;
  }
};

/// A triangulation that is exactly regular for the sites it was last given.
template <class T, int Dim>
concept RegularTriangulation = requires(T t, const T ct, std::span<const int> moved,
                                        const Columns<Dim>& sites, const Eigen::VectorXd& weights,
                                        void (*visit)(int, int)) {
  t.build(sites, weights);
  { t.move(moved, sites, weights) } -> std::same_as<UpdateReport>;
  ct.for_each_edge(visit);
  ct.for_each_neighbour(int{}, [](int) {});
  // Visits the edges that the last update made.
  ct.for_each_new_edge(visit);
  // All edges, sorted.
  { t.edges() } -> std::same_as<std::span<const EdgeList::Edge>>;
  { ct.hidden() } -> std::convertible_to<std::span<const int>>;
  { ct.size() } -> std::convertible_to<int>;
  { ct.site(int{}) } -> std::same_as<Vec<Dim>>;
  { ct.weight(int{}) } -> std::same_as<double>;
  // Says what is wrong with it, checked exactly: nothing.
  { ct.audit().empty() } -> std::same_as<bool>;
};

}  // namespace lagrain
