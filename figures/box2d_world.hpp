// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Box2D 2.4 as an engine for our scenes. Nothing of Box2D shows in this header.

#include "engine.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lagrain::figures {

/// A Box2D world in the state of a run, with its discs, walls, friction and restitution.
///
/// * Its units are those of Box2dSettings: a game's tolerances are absolute, so a scene in
///   millimetres would be all tolerance. Masses are divided by their mean.
/// * Edges have a skin of two slops, within which they already repel. Walls are moved back by it,
///   so that a disc at rest lies where the true wall is, to a slop; segments away from the side on
///   which most grains start. Half-spaces become long edges, solid from both sides.
/// * Nothing sleeps and nothing is damped.
/// * Box2D moves nothing by more than 2 of its metres in a step, whatever its velocity.
class Box2dWorld final : public Engine {
 public:
  /// @throws ContractError if a wall moves or is round, or materials differ in their laws
  Box2dWorld(const Run<2>& run, const Box2dSettings& settings);
  ~Box2dWorld() override;

  void step() override;
  double time() const override { return static_cast<double>(steps_) * time_step(); }
  double time_step() const override;
  Columns<2> positions() const override;
  Columns<2> velocities() const override;
  Columns<1> spins() const override;
  /// Forces are the impulses of the last step over its duration; what continuous collisions add is
  /// not in them.
  std::vector<ContactRecord<2>> contacts() const override;
  Vec<2> wall_force(int wall) const override;
  const Eigen::VectorXd& radii() const override { return radii_; }
  /// As Box2D has them: single precision.
  const Eigen::VectorXd& masses() const override { return masses_; }

  double slop() const;               ///< Box2D's tolerance of length [m]
  Eigen::VectorXd inertias() const;  ///< N [kg m^2]

 private:
  struct World;

  /// Box2D's units [m, s, kg].
  struct Units {
    double length = 1;
    double time = 1;
    double mass = 1;
  };

  void add_disc(const Run<2>& run, int i);
  void add_wall(const Run<2>& run, const Wall<2>& wall);
  double force_unit() const { return units_.mass * units_.length / (units_.time * units_.time); }

  Box2dSettings settings_;
  Units units_;
  Eigen::VectorXd radii_, masses_;
  std::vector<Wall<2>> walls_;
  std::unique_ptr<World> world_;
  std::int64_t steps_ = 0;
};

/// "2.4.1": of the library that runs.
std::string box2d_version();

}  // namespace lagrain::figures
