// SPDX-License-Identifier: GPL-3.0-or-later
#include "classics.hpp"

#include "measure.hpp"
#include "walls_by_name.hpp"

#include <lagrain/frame.hpp>
#include <lagrain/golden_section.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>

namespace lagrain::figures {

double janssen_length(std::span<const double> depth, std::span<const double> stress,
                      double weight) {
  const auto misfit = [&](double length) {
    double sum = 0;
    for (std::size_t k = 0; k < depth.size(); ++k) {
      const double d = stress[k] - janssen_stress(depth[k], weight, length);
      sum += d * d;
    }
    return sum;
  };
  // It has one minimum, which is looked for in the logarithm of the length.
  const double deepest = std::log(*std::max_element(depth.begin(), depth.end()));
  const double thousand = std::log(1e3);
  return std::exp(least_between(deepest - thousand, deepest + thousand,
                                [&](double log_length) { return misfit(std::exp(log_length)); }));
}

std::vector<double> flank_angles(const Columns<2>& x, const Eigen::VectorXd& radius) {
  const double step = 4 * radius.mean();
  std::map<long, Vec<2>> tops;  // column -> the highest point in it
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vec<2> top(x(0, i), x(1, i) + radius[i]);
    const auto [at, fresh] = tops.try_emplace(std::lround(top[0] / step), top);
    if (!fresh && top[1] > at->second[1]) at->second = top;
  }
  const auto peak = std::max_element(tops.begin(), tops.end(), [](const auto& a, const auto& b) {
    return a.second[1] < b.second[1];
  });
  const Vec<2> summit = peak->second;
  std::array<std::array<std::vector<double>, 2>, 2> flanks;  // left, right: places, heights
  for (const auto& [column, top] : tops) {
    if (top[1] < 0.2 * summit[1] || top[1] > 0.8 * summit[1]) continue;
    auto& flank = flanks[top[0] < summit[0] ? 0 : 1];
    for (std::size_t d = 0; d < 2; ++d) flank[d].push_back(top[static_cast<Eigen::Index>(d)]);
  }
  std::vector<double> angles;
  for (const auto& flank : flanks) {
    if (flank[0].size() < 3) continue;
    angles.push_back(std::abs(std::atan(bench::slope_of(flank[0], flank[1]))));
  }
  return angles;
}

JanssenSilo run_silo(Run<2>& run, const FigureOptions& options) {
  constexpr double kMeans = 0.8, kEvery = 5e-3;  // [s]
  const MeasuredRegion<2>& measure = run.scene().measures.front();
  const auto slices = static_cast<std::size_t>(measure.slices);
  const Vec<2> size = measure.region.high - measure.region.low;
  const double slice = size[1] / measure.slices;
  const std::vector<SeriesColumn> columns = series_columns(run);
  const auto column_of = [&](std::size_t k, const char* what) {
    const std::string name = measure.name + " " + std::to_string(k + 1) + "." + what;
    return static_cast<std::size_t>(
        std::find_if(columns.begin(), columns.end(),
                     [&](const SeriesColumn& c) { return c.name == name; }) -
        columns.begin());
  };

  JanssenSilo silo{.depth = std::vector<double>(slices),
                   .vertical = std::vector<double>(slices),
                   .horizontal = std::vector<double>(slices),
                   .width = size[0]};
  std::vector<double> solid(slices);
  double along = 0, across = 0;
  int samples = 0;
  const double end = run.scene().duration;
  for (double t = kEvery; t < end; t += kEvery) {
    options.check_stop();
    run.advance_to(t);
    if (t < end - kMeans) continue;
    const Sample row = sample_of(run, run.ledger(), run.statistics());
    for (std::size_t k = 0; k < slices; ++k) {
      solid[k] += std::get<double>(row[column_of(k, "solid")]);
      silo.vertical[k] += std::get<double>(row[column_of(k, "syy")]);
      silo.horizontal[k] += std::get<double>(row[column_of(k, "sxx")]);
    }
    for (const char* side : {"left", "right"}) {
      const Vec<2>& force = wall_named(run.walls(), side).force;
      across += std::abs(force[0]);
      along -= force[1];
    }
    ++samples;
  }
  // Depth is what lies above over the weight of the bed, so that a rough surface has one, too.
  const double weight = run.scene().materials.front().density * -run.scene().gravity[1] / samples;
  const double densest = *std::max_element(solid.begin(), solid.end());
  int full = 0;
  for (const double s : solid) {
    if (s < 0.9 * densest) continue;  // above the surface
    silo.weight += weight * s;
    ++full;
  }
  silo.weight /= full;
  double above = 0;
  for (std::size_t k = slices; k-- > 0;) {
    silo.vertical[k] /= samples;
    silo.horizontal[k] /= samples;
    const double here = weight * solid[k] * slice;
    silo.depth[k] = (above + 0.5 * here) / silo.weight;
    above += here;
  }
  silo.wall_friction = along / across;
  double vertical = 0, horizontal = 0;
  for (std::size_t k = 0; k < slices; ++k) {
    if (silo.depth[k] < 0.5 * silo.depth.front()) continue;
    vertical += silo.vertical[k];
    horizontal += silo.horizontal[k];
  }
  silo.lateral_ratio = horizontal / vertical;
  return silo;
}

Biaxial run_biaxial(Run<2>& run, const FigureOptions& options) {
  constexpr double kMeans = 20e-3;  // [s]
  constexpr int kSamples = 20;
  const double height = wall_named(run.walls(), "top").point[1];
  const double start = std::get<Steady<2>>(wall_named(run.walls(), "top").motion).start;
  run.advance_to(start);
  Biaxial test;
  const double rested = wall_named(run.walls(), "side").point[0];
  for (double t = start; t + kMeans < run.scene().duration;) {
    options.check_stop();
    double axial = 0, lateral = 0, wide = 0, high = 0;
    for (int k = 0; k < kSamples; ++k) {
      t += kMeans / kSamples;
      run.advance_to(t);
      const Wall<2>&side = wall_named(run.walls(), "side"), &top = wall_named(run.walls(), "top");
      wide += side.point[0] / kSamples;
      high += top.point[1] / kSamples;
      axial += top.force[1] / side.point[0] / kSamples;
      lateral += side.force[0] / top.point[1] / kSamples;
    }
    test.strain.push_back(1 - high / height);
    test.dilation.push_back(wide * high / (rested * height) - 1);
    test.axial.push_back(axial);
    test.lateral.push_back(lateral);
  }
  return test;
}

}  // namespace lagrain::figures
