// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Two engines for one scene of discs, Box2D's and ours, asked the same questions in SI.

#include "figure.hpp"

#include <lagrain/run.hpp>

#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace lagrain::figures {

/// An engine in the midst of a scene.
class Engine {
 public:
  virtual ~Engine() = default;

  /// @throws SimulationError if the engine sees that its physics went wrong
  virtual void step() = 0;
  virtual double time() const = 0;                             ///< [s]
  virtual double time_step() const = 0;                        ///< [s]
  virtual Columns<2> positions() const = 0;                    ///< 2 x N [m]
  virtual Columns<2> velocities() const = 0;                   ///< 2 x N [m/s]
  virtual Columns<1> spins() const = 0;                        ///< N [rad/s]
  virtual std::vector<ContactRecord<2>> contacts() const = 0;  ///< in no order
  virtual Vec<2> wall_force(int wall) const = 0;               ///< by the grains, last step [N]
  virtual const Eigen::VectorXd& radii() const = 0;            ///< N [m]
  virtual const Eigen::VectorXd& masses() const = 0;           ///< N [kg]
};

/// lagrain with linear springs; they and their step replace those of the scene.
struct LagrainSettings {
  double stiffness = 0;   ///< [N/m]
  double refinement = 1;  ///< the largest step that lagrain allows over the time step, at least 1
};

/// Box2D as its users set it. Its metre and second are those of a game: a scene is scaled so that
/// its mean radius is `mean_radius` and its gravity 10 m/s^2; without gravity seconds stay seconds.
struct Box2dSettings {
  double time_step = 1.0 / 60;  ///< [Box2D's s]
  int velocity_iterations = 8;  ///< the manual's
  int position_iterations = 3;  ///< the manual's
  bool continuous = true;       ///< sees collisions within a step: with walls, and of the bullet
  int bullet = -1;              ///< disc that is looked after likewise among discs; -1: none
  double bounce_above = 0;      ///< slower approaches do not bounce [Box2D's m/s]; its default is 1
  double mean_radius = 1;       ///< [Box2D's m]; its tolerance ("slop") is 0.005 of these metres
};

using EngineSettings = std::variant<LagrainSettings, Box2dSettings>;

/// An engine at time 0 of a scene, on one thread. Both take the grains where make_run puts them.
/// @throws SceneError as make_run; ContractError where Box2D cannot run the scene
std::unique_ptr<Engine> make_engine(const Scene<2>& scene, const EngineSettings& settings);

/// "Box2D, 1/60 s, 8/3, CCD" (iterations for velocities and places; continuous collisions),
/// "lagrain, 1e+04 N/m, largest step / 4".
std::string name_of(const EngineSettings& settings);
/// Which of the two.
inline bool is_box2d(const EngineSettings& settings) {
  return std::holds_alternative<Box2dSettings>(settings);
}

/// A scene without grains in the units for which Box2D's tolerances are made: discs of about 1 m
/// and 1 kg/m^3, 10 m/s^2.
Scene<2> game_scene();
inline constexpr double kGameGravity = 10;  ///< [m/s^2]

/// Steps to a time [s], to half a step.
/// @return the processor time of the steps [s]
/// @throws Interrupted, and SimulationError as step()
double advance_to(Engine& engine, double t, const FigureOptions& options);

/// Overlaps by a search of its own, which knows places and radii alone; walls are those of
/// the scene.
struct Overlaps {
  double mean = 0;          ///< of touching pairs, walls included, over the smaller radius [-]
  double largest = 0;       ///< [-]
  double coordination = 0;  ///< mean number of touching partners of a disc, walls included [-]
  int escaped = 0;          ///< discs with their centre behind a wall; they count nowhere else
};
Overlaps overlaps_of(const Columns<2>& x, const Eigen::VectorXd& radius,
                     const std::vector<Wall<2>>& walls);

/// Force on all walls, downwards, over the weight of all grains [-]: 1 at rest.
double wall_load(const Engine& engine, const Scene<2>& scene);

}  // namespace lagrain::figures
