// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes of the speed report, and the beds that they start from.

#include "contest.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::bench {

namespace {

/// All scenes, each a function that makes its beds and lets the contenders compete on them.
class Scenes {
 public:
  Scenes(Contest& contest, bool quick) : contest_(contest), quick_(quick) {}

  std::vector<std::function<void()>> all() {
    std::vector<std::function<void()>> scenes;
    add_settled(scenes);
    add_sizes(scenes);
    add_impacts(scenes);
    add_moving(scenes);
    add_growth(scenes);
    return scenes;
  }

 private:
  static constexpr double kRadius = 0.02;  // of the discs, the larger ones, and of most balls [m]

  /// As many steps as give each contender about the same work, whatever the number of grains.
  Plan plan_for(int grains, double grain_steps) const {
    Plan plan;
    const double effort = quick_ ? grain_steps / 40 : grain_steps;
    // Long turns: the first step of each takes one more pass over the grains.
    plan.steps =
        kTurns * std::clamp(static_cast<int>(effort / grains / kTurns), quick_ ? 2 : 20, 250);
    plan.warm_up = std::min(200, 2 * plan.steps);  // margins adapt
    if (quick_) plan.rounds = 2;
    return plan;
  }

  /// The plan for a shaken bed: two whole periods, after one in which lists and skins settle.
  template <int Dim>
  Plan plan_of_period(const Bed<Dim>& bed, double radius) const {
    Plan plan = plan_for(bed.count(), 3e6);
    const double period = shake_period(radius) / bed.setting.time_step / (quick_ ? 16 : 1);
    plan.warm_up = static_cast<int>(std::lround(period));
    plan.steps = kTurns * static_cast<int>(std::lround(2 * period / kTurns));
    return plan;
  }

  // Beds. Each tile settles once.

  const Bed<2>& disc_tile() {
    const int count = quick_ ? 250 : 1000;
    return tile<2>({count, kRadius, 0.7 * kRadius, quick_ ? 0.42 : 0.6});
  }
  /// A quarter of the unit cube's grains in a quarter of its area; an eighth as many if quick, of
  /// twice the radius.
  const Bed<3>& ball_tile(int count, double radius) {
    const double larger = quick_ ? 2 * radius : radius;
    return tile<3>({quick_ ? count / 8 : count, larger, larger, 0.5});
  }
  template <int Dim>
  const Bed<Dim>& tile(const Pour<Dim>& what) {
    auto& tiles = tiles_of<Dim>();
    const std::pair<int, double> key{what.count, what.radius};
    auto at = tiles.find(key);
    if (at == tiles.end()) {
      contest_.say("settling " + std::to_string(what.count) + (Dim == 2 ? " discs" : " spheres"));
      at = tiles.emplace(key, pour<Dim>(what, contest_.check_stop())).first;
    }
    return at->second;
  }
  template <int Dim>
  std::map<std::pair<int, double>, Bed<Dim>>& tiles_of() {
    if constexpr (Dim == 2) {
      return disc_tiles_;
    } else {
      return ball_tiles_;
    }
  }

  /// The bed without its highest grains, as long as there are more than `count`.
  static Bed<3> trimmed(Bed<3> bed, int count) {
    std::stable_sort(bed.grains.begin(), bed.grains.end(),
                     [](const auto& a, const auto& b) { return a.position.z() < b.position.z(); });
    if (bed.count() > count) bed.grains.resize(static_cast<std::size_t>(count));
    return bed;
  }

  // Scenes.

  void add_settled(std::vector<std::function<void()>>& scenes) {
    scenes.emplace_back([this] {
      const Bed<2> bed = tiled<2>(disc_tile(), {quick_ ? 4 : 20});
      compete<2>(kSettledGroup, "discs", bed, plan_for(bed.count(), 6e6), bed.count());
    });
    struct Cube {
      int tile;
      int count;
      double radius;
    };
    // The paper's boxes, each made of four quarters.
    for (const Cube& cube : {Cube{371, 1484, 0.04}, {875, 3498, 0.03}, {1736, 6944, 0.02}}) {
      if (quick_ && cube.tile != 371) continue;
      scenes.emplace_back([this, cube] {
        const Bed<3> bed = trimmed(tiled<3>(ball_tile(cube.tile, cube.radius), {2, 2}), cube.count);
        compete<3>(kSettledGroup, "spheres", bed, plan_for(bed.count(), 3e6), bed.count());
      });
    }
    if (quick_) return;
    scenes.emplace_back([this] {
      const Bed<3> bed = tiled<3>(ball_tile(1736, kRadius), {6, 6});
      Plan plan = plan_for(bed.count(), 3e6);
      plan.rounds = 2;
      plan.rebuilt = false;
      compete<3>(kSettledGroup, "spheres", bed, plan, bed.count());
    });
  }

  template <int Dim>
  std::unique_ptr<Match<Dim>> mixture(const Bed<Dim>& tile, const std::vector<int>& copies,
                                      int ratio, int large) {
    Bed<Dim> bed = tiled<Dim>(tile, copies);
    const double small = bed.grains.front().radius;
    const double largest =
        std::max_element(bed.grains.begin(), bed.grains.end(), [](const auto& a, const auto& b) {
          return a.radius < b.radius;
        })->radius;
    contest_.say("sizes 1 : " + std::to_string(ratio));
    if (large > 0) {
      put_large_grains<Dim>(bed, ratio * (Dim == 3 ? small : largest), large,
                            contest_.check_stop());
    }
    Plan plan = plan_for(bed.count(), 3e6);
    plan.multi = ratio > 1;
    plan.bin = ratio <= 10;
    plan.rebuilt = false;
    return contest_.prepare<Dim>(
        kSizesGroup, std::string(Dim == 2 ? "discs" : "spheres") + " 1 : " + std::to_string(ratio),
        bed, plan, ratio);
  }
  void add_sizes(std::vector<std::function<void()>>& scenes) {
    struct Mix {
      int ratio, tiles, large;
    };
    scenes.emplace_back([this] {
      std::vector<std::unique_ptr<Match<2>>> matches;
      for (const Mix& mix : {Mix{1, 20, 0}, {10, 21, 10}, {30, 22, 4}, {100, 30, 2}}) {
        if (quick_ && mix.ratio > 10) continue;
        matches.push_back(mixture<2>(disc_tile(), {quick_ ? 4 : mix.tiles}, mix.ratio,
                                     quick_ ? std::min(mix.large, 2) : mix.large));
      }
      contest_.compete(matches);
    });
    if (quick_) return;
    scenes.emplace_back([this] {
      std::vector<std::unique_ptr<Match<3>>> matches;
      for (const Mix& mix : {Mix{1, 4, 0}, {10, 4, 5}, {30, 4, 1}}) {
        matches.push_back(
            mixture<3>(ball_tile(1736, kRadius), {mix.tiles, mix.tiles}, mix.ratio, mix.large));
      }
      contest_.compete(matches);
    });
  }

  /// The settled box, five times as hard, and above its middle a ball of five radii.
  Bed<3> target() {
    constexpr double kHarder = 5, kBall = 5;
    Bed<3> tile = ball_tile(quick_ ? 371 : 1736, quick_ ? 2 * kRadius : kRadius);
    const double r = tile.grains.front().radius;
    contest_.say("making the target");
    settle<3>(tile, r, r, {{1 / kHarder, 2}}, contest_.check_stop());
    Bed<3> bed = tiled<3>(tile, {2, 2});
    choose_law<3>(bed, r, r, kRestitution, 1 / kHarder);
    Grain<3> ball;
    ball.radius = kBall * r;
    ball.mass = kDensity * grain_volume<3>(ball.radius);
    ball.position = 0.5 * bed.size;
    ball.position.z() = ball.radius;
    for (const Grain<3>& grain : bed.grains) {
      const double reach = 1.0001 * (ball.radius + grain.radius);
      const double beside = (ball.position - grain.position).head<2>().squaredNorm();
      if (beside >= reach * reach) continue;
      ball.position.z() =
          std::max(ball.position.z(), grain.position.z() + std::sqrt(reach * reach - beside));
    }
    bed.grains.push_back(ball);
    return bed;
  }
  void add_impacts(std::vector<std::function<void()>>& scenes) {
    scenes.emplace_back([this] {
      Bed<3> bed = target();
      Plan plan = plan_for(bed.count(), 3e6);
      plan.warm_up = 10;
      plan.multi = true;
      std::vector<std::unique_ptr<Match<3>>> matches;
      for (const int speed : {0, 1, 10, 50}) {
        if (quick_ && speed == 1) continue;
        bed.grains.back().velocity = {0, 0, -static_cast<double>(speed)};
        matches.push_back(contest_.prepare<3>(
            kImpactGroup, "a ball of 5 r at " + std::to_string(speed) + " m/s", bed, plan, speed));
      }
      contest_.compete(matches);
    });
  }

  void add_moving(std::vector<std::function<void()>>& scenes) {
    scenes.emplace_back([this] {
      Bed<2> bed = tiled<2>(disc_tile(), {quick_ ? 2 : 5});
      contest_.say("a column starts to collapse");
      bed.size[0] *= 3;  // the right wall gives way
      bed.walls = open_box<2>(bed.size);
      advance<2>(bed, steps_for(bed, kRadius, 6), contest_.check_stop());
      compete<2>(kMovingGroup, "a column of discs collapses", bed, plan_for(bed.count(), 3e6), 0);
    });
    scenes.emplace_back([this] {
      Bed<2> bed = tiled<2>(disc_tile(), {quick_ ? 2 : 10});
      contest_.say("shaking discs");
      shake<2>(bed, kRadius, contest_.check_stop());
      compete<2>(kMovingGroup, "discs shaken with 4 g", bed, plan_of_period(bed, kRadius), 0);
    });
    scenes.emplace_back([this] {
      Bed<3> bed = ball_tile(quick_ ? 371 : 1736, quick_ ? 2 * kRadius : kRadius);
      contest_.say("shaking spheres");
      const double radius = bed.grains.front().radius;
      shake<3>(bed, radius, contest_.check_stop());
      compete<3>(kMovingGroup, "spheres shaken with 4 g", bed, plan_of_period(bed, radius), 0);
    });
  }

  void add_growth(std::vector<std::function<void()>>& scenes) {
    scenes.emplace_back([this] {
      std::vector<std::unique_ptr<Match<2>>> matches;
      for (const int tiles : quick_ ? std::vector<int>{1, 4} : std::vector<int>{1, 10, 100, 1000}) {
        const Bed<2> bed = tiled<2>(disc_tile(), {tiles});
        Plan plan = plan_for(bed.count(), 3e6);
        plan.oracle = plan.rebuilt = plan.lammps = false;
        matches.push_back(contest_.prepare<2>(kGrowthGroup, "discs", bed, plan, bed.count()));
      }
      contest_.compete(matches);
    });
  }

  /// One scene alone.
  template <int Dim>
  void compete(const std::string& group, const std::string& what, const Bed<Dim>& bed,
               const Plan& plan, double parameter) {
    std::vector<std::unique_ptr<Match<Dim>>> match;
    match.push_back(contest_.prepare<Dim>(group, what, bed, plan, parameter));
    contest_.compete(match);
  }

  Contest& contest_;
  bool quick_;
  std::map<std::pair<int, double>, Bed<2>> disc_tiles_;
  std::map<std::pair<int, double>, Bed<3>> ball_tiles_;
};

}  // namespace

SpeedResults measure_speed(const FigureOptions& options,
                           const std::optional<std::filesystem::path>& lammps,
                           const std::function<void(const SpeedResults&)>& after_scene) {
  Contest contest(options, lammps);
  Scenes scenes(contest, options.quick);
  const std::vector<std::function<void()>> all = scenes.all();
  for (std::size_t k = 0; k < all.size(); ++k) {
    contest.set_progress(static_cast<double>(k) / static_cast<double>(all.size()));
    all[k]();
    after_scene(contest.results());
  }
  return contest.results();
}

}  // namespace lagrain::bench
