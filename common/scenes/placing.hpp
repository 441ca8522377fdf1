// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the sources of scenes: what the placing of grains at time 0 and later share.

#include <lagrain/grains.hpp>
#include <lagrain/random.hpp>
#include <lagrain/scene.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <variant>
#include <vector>

namespace lagrain::detail {

/// The largest radius of a law [m].
inline double largest(const RadiusLaw& law) {
  if (const auto* r = std::get_if<double>(&law)) return *r;
  if (const auto* u = std::get_if<UniformRadius>(&law)) return u->high;
  if (const auto* s = std::get_if<SieveCurve>(&law)) return s->openings.back() / 2;
  const auto& listed = std::get<ListedRadius>(law);
  return *std::max_element(listed.values.begin(), listed.values.end());
}

/// The smallest radius of a law [m].
inline double smallest(const RadiusLaw& law) {
  if (const auto* r = std::get_if<double>(&law)) return *r;
  if (const auto* u = std::get_if<UniformRadius>(&law)) return u->low;
  if (const auto* s = std::get_if<SieveCurve>(&law)) return s->openings.front() / 2;
  const auto& listed = std::get<ListedRadius>(law);
  return *std::min_element(listed.values.begin(), listed.values.end());
}

/// Draws radii from a law. Masses go with radius^Dim: grains of one fill have one density.
template <int Dim>
class RadiusDraw {
 public:
  explicit RadiusDraw(const RadiusLaw& law) : law_(law) {
    if (const auto* listed = std::get_if<ListedRadius>(&law)) {
      numbers_ = listed->weights;
      if (listed->by == Share::number) return;
      const double unit = *std::min_element(listed->values.begin(), listed->values.end());
      for (std::size_t k = 0; k < numbers_.size(); ++k) {
        numbers_[k] *= std::pow(unit / listed->values[k], Dim);
      }
    } else if (const auto* curve = std::get_if<SieveCurve>(&law)) {
      const double unit = curve->openings.front();
      for (std::size_t k = 0; k + 1 < curve->openings.size(); ++k) {
        const double a = unit / curve->openings[k];
        const double b = unit / curve->openings[k + 1];
        // The mean of 1 / radius^Dim between the two: the number of grains in a unit of mass.
        const double mean = Dim == 2 ? a * b : 0.5 * (a + b) * a * b;
        numbers_.push_back((curve->passing[k + 1] - curve->passing[k]) * mean);
      }
    }
  }

  double operator()(Random& random) const {
    if (const auto* r = std::get_if<double>(&law_)) return *r;
    if (const auto* u = std::get_if<UniformRadius>(&law_)) {
      return u->by == Share::number ? random.uniform(u->low, u->high)
                                    : uniform_in_mass(u->low, u->high, random);
    }
    const std::size_t k = pick(random);
    if (const auto* listed = std::get_if<ListedRadius>(&law_)) return listed->values[k];
    const auto& openings = std::get<SieveCurve>(law_).openings;
    return uniform_in_mass(openings[k] / 2, openings[k + 1] / 2, random);
  }

 private:
  std::size_t pick(Random& random) const {
    double left = random.uniform() * std::accumulate(numbers_.begin(), numbers_.end(), 0.0);
    std::size_t k = 0;
    while (k + 1 < numbers_.size() && left >= numbers_[k]) left -= numbers_[k++];
    return k;
  }

  /// The number of grains between r and r + dr goes with dr / r^Dim: r^(1 - Dim) is uniform.
  static double uniform_in_mass(double low, double high, Random& random) {
    constexpr int kPower = Dim - 1;
    const double end = std::pow(low / high, kPower);
    const double ratio = std::pow(1 - random.uniform() * (1 - end), -1.0 / kPower);
    return std::min(low * ratio, high);
  }

  const RadiusLaw& law_;
  std::vector<double> numbers_;  // relative ones, of the values of a list or between two sieves
};

/// A direction at random.
template <int Dim>
Vec<Dim> random_direction(Random& random) {
  Vec<Dim> v;
  for (int d = 0; d < Dim; ++d) v[d] = random.normal();
  return v.normalized();
}

/// A grain as a fill or an inlet has it, at x.
template <int Dim, class Source>
Grain<Dim> grain_from(const Scene<Dim>& scene, const Source& source, double radius,
                      const Vec<Dim>& x, Random& random) {
  Grain<Dim> grain;
  grain.position = x;
  grain.radius = radius;
  grain.material = source.material;
  grain.mass = scene.materials[static_cast<std::size_t>(source.material)].density *
               grain_volume<Dim>(radius, scene.depth);
  grain.velocity = source.velocity;
  if (source.random_speed > 0) {
    grain.velocity += source.random_speed * random_direction<Dim>(random);
  }
  if constexpr (requires { source.pinned; }) {
    grain.omega = source.spin;
    grain.pinned = source.pinned;
    grain.driven = source.driven;
  }
  return grain;
}

/// A grain of each inlet, as small as they come: the time step has to be safe for it.
template <int Dim>
std::vector<Grain<Dim>> smallest_newcomers(const Scene<Dim>& scene) {
  std::vector<Grain<Dim>> grains;
  Random random(1);
  for (const Inlet<Dim>& inlet : scene.inlets) {
    grains.push_back(
        grain_from(scene, inlet, smallest(inlet.radius), Vec<Dim>(inlet.region.low), random));
  }
  return grains;
}

/// Why no contact can be in a scene that has none to set the time step.
template <int Dim>
std::string why_no_contact(const Scene<Dim>& scene) {
  return scene.apart().empty() ? "nothing in the scene can move"
                               : "nothing in the scene that can move touches anything";
}

/// Whether a ball lies on the free side of all walls, and touches none.
template <int Dim>
bool clear_of_walls(const std::vector<Wall<Dim>>& walls, const Vec<Dim>& x, double r) {
  bool clear = true;
  std::vector<int> found;
  for (const Wall<Dim>& wall : walls) {
    wall.for_each_near(x, r, found,
                       [&](int piece) { clear = clear && wall.foot(piece, x).distance >= r; });
  }
  return clear;
}

}  // namespace lagrain::detail
