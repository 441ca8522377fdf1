// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the sources of runs: who comes and who leaves, and when.

#include "placing.hpp"

#include <lagrain/grains.hpp>
#include <lagrain/placement.hpp>
#include <lagrain/random.hpp>
#include <lagrain/run.hpp>
#include <lagrain/scene.hpp>
#include <lagrain/state.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace lagrain::detail {

/// Looks after the inlets, the outlets and the domain of a scene.
///
/// A look decides by places and times alone, so that it is the same for all neighbourhoods and any
/// number of threads.
template <int Dim>
class Traffic {
 public:
  /// Steps from one look to the next. By default that is four contacts long, in which a grain of a
  /// sound run moves by a small part of its radius. Whoever comes or leaves may have to wait so
  /// long. An exchange lists the near pairs anew, which took as long as 6 steps of a gas of 10,000
  /// discs, and less against those of a bed. Where most grains fly the triangulation is built anew
  /// as well, which took as long as 120 steps of a gas of 8,000 spheres. At half of the number
  /// exchanges cost up to twice as much, at twice grains wait longer.
  static constexpr int kStepsBetweenLooks = 100;

  explicit Traffic(const Scene<Dim>& scene);

  /// Grains that leave, and grains that come.
  struct Change {
    std::vector<int> leavers;           ///< numbers, in increasing order
    std::vector<Grain<Dim>> newcomers;  ///< they overlap with nothing
    std::vector<int> groups;            ///< of the newcomers, see Run::groups
  };
  /// Who leaves and comes at this instant; it is counted at once. Also who has passed through an
  /// outlet since `remember` was called last leaves.
  Change look(const Run<Dim>& run);
  /// Takes note of where all grains are, to be called at the start and after each look.
  void remember(const Run<Dim>& run);

  const TrafficCounts& counts() const { return counts_; }  ///< so far

  /// Keeps or restores who has come and left, and the random numbers of those who will come.
  /// @param grains  that are there
  void persist(StateVisitor visit, int grains);

 private:
  struct Source {
    Random random;
    RadiusDraw<Dim> draw;
    std::optional<double> next_radius;  // of the grain that waits for room [m]
  };

  bool leaves(const Run<Dim>& run, int number);
  void let_in(const Run<Dim>& run, std::size_t inlet, Change& change);

  const Scene<Dim>& scene_;
  std::vector<Source> sources_;  // of the inlets
  Columns<Dim> before_;          // where all grains were at the last look
  TrafficCounts counts_;
};

/// How many grains an inlet owes by time t [s].
template <int Dim>
std::int64_t due(const Inlet<Dim>& inlet, double t);

/// @throws SceneError if a grain lies outside of the domain
template <int Dim>
void expect_in_domain(const Scene<Dim>& scene, const Placement<Dim>& placement);

}  // namespace lagrain::detail
