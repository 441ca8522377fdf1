// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine.hpp"

#include "box2d_world.hpp"
#include "measure.hpp"

#include <lagrain/numbers.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace lagrain::figures {

namespace {

class LagrainEngine final : public Engine {
 public:
  explicit LagrainEngine(std::unique_ptr<Run<2>> run) : run_(std::move(run)) {}

  void step() override { run_->step(); }
  double time() const override { return run_->time(); }
  double time_step() const override { return run_->time_step(); }
  Columns<2> positions() const override { return run_->positions(); }
  Columns<2> velocities() const override { return run_->velocities(); }
  Columns<1> spins() const override {
    return run_->spins() ? *run_->spins() : Columns<1>(Columns<1>::Zero(1, run_->count()));
  }
  std::vector<ContactRecord<2>> contacts() const override { return run_->contacts(); }
  Vec<2> wall_force(int wall) const override {
    return run_->walls()[static_cast<std::size_t>(wall)].force;
  }
  const Eigen::VectorXd& radii() const override { return run_->radii(); }
  const Eigen::VectorXd& masses() const override { return run_->masses(); }

 private:
  std::unique_ptr<Run<2>> run_;
};

}  // namespace

std::unique_ptr<Engine> make_engine(const Scene<2>& scene, const EngineSettings& settings) {
  Scene<2> safe = scene;
  safe.time_step = {.fraction_of_contact = 1e-3};
  if (const auto* box2d = std::get_if<Box2dSettings>(&settings)) {
    return std::make_unique<Box2dWorld>(*make_run(safe, 1), *box2d);
  }
  const auto& ours = std::get<LagrainSettings>(settings);
  safe.law.stiffness = ours.stiffness;
  Scene<2> sprung = safe;
  sprung.time_step.seconds = make_run(safe, 1)->time_scales().safe_step / ours.refinement;
  return std::make_unique<LagrainEngine>(make_run(sprung, 1));
}

std::string name_of(const EngineSettings& settings) {
  if (const auto* box2d = std::get_if<Box2dSettings>(&settings)) {
    return "Box2D, 1/" + rounded(1 / box2d->time_step, 4) + " s, " +
           std::to_string(box2d->velocity_iterations) + "/" +
           std::to_string(box2d->position_iterations) + (box2d->continuous ? ", CCD" : "");
  }
  const auto& ours = std::get<LagrainSettings>(settings);
  return "lagrain, " + rounded(ours.stiffness, 2) + " N/m, largest step" +
         (ours.refinement > 1 ? " / " + rounded(ours.refinement) : "");
}

Scene<2> game_scene() {
  Scene<2> scene;
  scene.gravity = {0, -kGameGravity};
  scene.law.stiffness = 1e5;  // for whoever asks no engine; each sets its own
  scene.materials = {{"stone", 1}};
  scene.largest_overlap = 0.5;
  return scene;
}

double advance_to(Engine& engine, double t, const FigureOptions& options) {
  // Long enough for the clock, short enough for whoever waits.
  const auto block = std::max<Eigen::Index>(1, 20000 / engine.radii().size());
  const double end = t - 0.5 * engine.time_step();
  double spent = 0;
  while (engine.time() < end) {
    options.check_stop();
    const double start = bench::processor_seconds();
    for (Eigen::Index k = 0; k < block && engine.time() < end; ++k) engine.step();
    spent += bench::processor_seconds() - start;
  }
  return spent;
}

Overlaps overlaps_of(const Columns<2>& x, const Eigen::VectorXd& radius,
                     const std::vector<Wall<2>>& walls) {
  Overlaps found;
  int touching = 0, partners = 0;
  const auto note = [&](double overlap, int discs) {
    if (!(overlap > 0)) return;
    found.mean += overlap;
    found.largest = std::max(found.largest, overlap);
    ++touching;
    partners += discs;
  };
  std::vector<Eigen::Index> inside;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const bool escaped = std::any_of(walls.begin(), walls.end(), [&](const Wall<2>& wall) {
      return wall.foot(x.col(i)).distance < 0;
    });
    if (escaped)
      ++found.escaped;
    else
      inside.push_back(i);
  }
  // Sweep from left to right.
  const auto left = [&](Eigen::Index i) { return x(0, i) - radius[i]; };
  std::sort(inside.begin(), inside.end(), [&](auto i, auto j) { return left(i) < left(j); });
  for (auto at = inside.begin(); at != inside.end(); ++at) {
    const Eigen::Index i = *at;
    for (auto next = at + 1; next != inside.end() && left(*next) < x(0, i) + radius[i]; ++next) {
      const Eigen::Index j = *next;
      const double distance = std::hypot(x(0, i) - x(0, j), x(1, i) - x(1, j));
      note((radius[i] + radius[j] - distance) / std::min(radius[i], radius[j]), 2);
    }
    for (const Wall<2>& wall : walls) note(1 - wall.foot(x.col(i)).distance / radius[i], 1);
  }
  if (touching > 0) found.mean /= touching;
  if (!inside.empty()) {
    found.coordination = static_cast<double>(partners) / static_cast<double>(inside.size());
  }
  return found;
}

double wall_load(const Engine& engine, const Scene<2>& scene) {
  Vec<2> force = Vec<2>::Zero();
  for (int w = 0; w < static_cast<int>(scene.walls.size()); ++w) force += engine.wall_force(w);
  return force.dot(scene.gravity) / (scene.gravity.squaredNorm() * engine.masses().sum());
}

}  // namespace lagrain::figures
