// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure.hpp"

#include <lagrain/grains.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

namespace lagrain::detail {
namespace {

/// The parts of a symmetric tensor, in the order of the columns.
template <int Dim>
constexpr std::array<std::array<int, 2>, Dim*(Dim + 1) / 2> kParts = [] {
  if constexpr (Dim == 2) {
    return std::array<std::array<int, 2>, 3>{{{0, 0}, {1, 1}, {0, 1}}};
  } else {
    return std::array<std::array<int, 2>, 6>{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  }
}();

/// Area of the unit disc left of x = a.
double area_left_of(double a) {
  return a * std::sqrt(1 - a * a) + std::asin(a) + std::numbers::pi / 2;
}

/// Area of the unit disc left of x = a and below y = b.
double area_of_corner(double a, double b) {
  a = std::clamp(a, -1.0, 1.0);
  b = std::clamp(b, -1.0, 1.0);
  const double left = area_left_of(a);
  const double below = area_left_of(b);
  if (a * a + b * b < 1) return (left + below) / 2 - std::numbers::pi / 4 + a * b;
  if (a < 0 && b < 0) return 0;
  if (a < 0) return left;
  if (b < 0) return below;
  return left + below - std::numbers::pi;
}

/// Volume [m^3] of the part of a grain in a box; of a disc with its depth.
double part_within(const Vec<2>& x, double r, const Vec<2>& low, const Vec<2>& high, double depth) {
  return depth * area_within(x, r, low, high);
}
double part_within(const Vec<3>& x, double r, const Vec<3>& low, const Vec<3>& high, double) {
  return volume_within(x, r, low, high);
}

/// What is measured of one slice.
template <int Dim>
struct Slice {
  double solid = 0;                                                                  // [m^3]
  Eigen::Matrix<double, Dim, Dim> moment = Eigen::Matrix<double, Dim, Dim>::Zero();  // [N m]
};

/// Which slice of a region a coordinate along its axis lies in; too small or large if in none.
template <int Dim>
double slice_at(const MeasuredRegion<Dim>& measure, double coordinate) {
  return (coordinate - measure.region.low[measure.axis]) /
         (measure.region.high[measure.axis] - measure.region.low[measure.axis]) * measure.slices;
}

template <int Dim>
bool holds(const MeasuredRegion<Dim>& measure, const Vec<Dim>& x) {
  return (x.array() >= measure.region.low.array()).all() &&
         (x.array() < measure.region.high.array()).all();
}

template <int Dim>
void add_grains(const Run<Dim>& run, const MeasuredRegion<Dim>& measure,
                std::vector<Slice<Dim>>& slices) {
  const double thickness =
      (measure.region.high[measure.axis] - measure.region.low[measure.axis]) / measure.slices;
  for (int i = 0; i < run.count(); ++i) {
    const Vec<Dim> x = run.positions().col(i);
    const double r = run.radii()[i];
    const double last = measure.slices - 1;
    const double from = std::floor(slice_at(measure, x[measure.axis] - r));
    const double to = std::floor(slice_at(measure, x[measure.axis] + r));
    if (!(to >= 0 && from <= last)) continue;
    for (int k = static_cast<int>(std::max(from, 0.0)); k <= std::min(to, last); ++k) {
      Vec<Dim> low = measure.region.low;
      Vec<Dim> high = measure.region.high;
      low[measure.axis] += k * thickness;
      high[measure.axis] = low[measure.axis] + thickness;
      slices[static_cast<std::size_t>(k)].solid += part_within(x, r, low, high, run.scene().depth);
    }
  }
}

template <int Dim>
void add_contact(const Run<Dim>& run, const ContactRecord<Dim>& contact,
                 const MeasuredRegion<Dim>& measure, std::vector<Slice<Dim>>& slices) {
  const double r = run.radii()[contact.i];
  const bool on_wall = contact.wall >= 0;
  // On a wall's surface, or in the middle of the overlap.
  const double to_point = r - (on_wall ? contact.overlap : contact.overlap / 2);
  const Vec<Dim> point = run.positions().col(contact.i) - to_point * contact.normal;
  if (!holds(measure, point)) return;
  const double branch = on_wall ? to_point : r + run.radii()[contact.j] - contact.overlap;
  const double k = std::clamp(std::floor(slice_at(measure, point[measure.axis])), 0.0,
                              static_cast<double>(measure.slices - 1));
  slices[static_cast<std::size_t>(k)].moment +=
      contact.force * (branch * contact.normal).transpose();
}

}  // namespace

double area_within(const Vec<2>& centre, double radius, const Vec<2>& low, const Vec<2>& high) {
  const Vec<2> a = (low - centre) / radius;
  const Vec<2> b = (high - centre) / radius;
  const double area = area_of_corner(b[0], b[1]) - area_of_corner(a[0], b[1]) -
                      area_of_corner(b[0], a[1]) + area_of_corner(a[0], a[1]);
  return std::max(0.0, area) * radius * radius;
}

double volume_within(const Vec<3>& centre, double radius, const Vec<3>& low, const Vec<3>& high) {
  const bool whole =
      ((centre - low).array() >= radius).all() && ((high - centre).array() >= radius).all();
  if (whole) return grain_volume<3>(radius);
  const double bottom = std::clamp((low[2] - centre[2]) / radius, -1.0, 1.0);
  const double top = std::clamp((high[2] - centre[2]) / radius, -1.0, 1.0);
  // Discs of the sphere, whose parts in the box are exact, at the midpoints of equal intervals of
  // the latitude: towards the poles, where their areas change fast, they lie close.
  constexpr int kDiscs = 16;
  const double step = (std::asin(top) - std::asin(bottom)) / kDiscs;
  double volume = 0;
  for (int k = 0; k < kDiscs; ++k) {
    const double latitude = std::asin(bottom) + (k + 0.5) * step;
    const double thickness = radius * std::cos(latitude) * step;
    volume += thickness * area_within(centre.head<2>(), radius * std::cos(latitude), low.head<2>(),
                                      high.head<2>());
  }
  return volume;
}

template <int Dim>
void add_measure_columns(const Scene<Dim>& scene, std::vector<SeriesColumn>& columns) {
  for (const MeasuredRegion<Dim>& measure : scene.measures) {
    for (int k = 0; k < measure.slices; ++k) {
      const std::string stem =
          measure.name + (measure.slices > 1 ? " " + std::to_string(k + 1) : std::string()) + ".";
      columns.push_back({stem + "solid", "-"});
      for (const auto [a, b] : kParts<Dim>) {
        columns.push_back({stem + "s" + "xyz"[a] + "xyz"[b], "Pa"});
      }
    }
  }
  for (const MeasuredPlane<Dim>& plane : scene.planes) {
    columns.push_back({plane.name + ".mass", "kg"});
    columns.push_back({plane.name + ".grains", "-"});
  }
}

template <int Dim>
void add_measures(const Run<Dim>& run, Sample& row) {
  const Scene<Dim>& scene = run.scene();
  std::vector<ContactRecord<Dim>> contacts;
  if (!scene.measures.empty()) contacts = run.contacts();
  for (const MeasuredRegion<Dim>& measure : scene.measures) {
    std::vector<Slice<Dim>> slices(static_cast<std::size_t>(measure.slices));
    add_grains(run, measure, slices);
    for (const auto& contact : contacts) add_contact(run, contact, measure, slices);
    const double volume = (measure.region.high - measure.region.low).prod() *
                          (Dim == 2 ? scene.depth : 1) / measure.slices;
    for (const Slice<Dim>& slice : slices) {
      row.emplace_back(slice.solid / volume);
      for (const auto [a, b] : kParts<Dim>) {
        row.emplace_back((slice.moment(a, b) + slice.moment(b, a)) / (2 * volume));
      }
    }
  }
  for (const PlaneFlow<Dim>& flow : run.flows()) {
    row.emplace_back(flow.mass());
    row.emplace_back(flow.grains());
  }
}

template void add_measure_columns<2>(const Scene<2>&, std::vector<SeriesColumn>&);
template void add_measure_columns<3>(const Scene<3>&, std::vector<SeriesColumn>&);
template void add_measures<2>(const Run<2>&, Sample&);
template void add_measures<3>(const Run<3>&, Sample&);

}  // namespace lagrain::detail
