// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What a run shows of itself: frames, which are states of all grains, and samples, which are rows
/// of the series. How they are spelled in a file is the business of a format (format.hpp).

#include <lagrain/run.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace lagrain {

/// The grains at one instant.
template <int Dim>
struct Frame {
  std::int64_t step = 0;                       ///< steps made until then
  double time = 0;                             ///< [s]
  std::vector<int> id;                         ///< N, in increasing order
  Columns<Dim> position;                       ///< Dim x N [m]
  Columns<Dim> velocity;                       ///< Dim x N [m/s]
  std::optional<Columns<kSpinDim<Dim>>> spin;  ///< N columns [rad/s]; none where nothing spins
  Eigen::VectorXd radius;                      ///< N [m]
  std::vector<int> material;                   ///< N, of the scene's

  /// The frame of this instant.
  static Frame of(const Run<Dim>& run) {
    Frame frame;
    frame.step = run.steps();
    frame.time = run.time();
    for (int i = 0; i < run.count(); ++i) frame.id.push_back(run.id(i));
    frame.position = run.positions();
    frame.velocity = run.velocities();
    if (run.spins() != nullptr) frame.spin = *run.spins();
    frame.radius = run.radii();
    frame.material = run.materials();
    return frame;
  }
};

/// A column of the series.
struct SeriesColumn {
  std::string name;  ///< without its unit
  std::string unit;  ///< "-" for a pure number
};

/// A row of the series: one value for each column.
using Sample = std::vector<std::variant<std::int64_t, double>>;

/// The columns of a run's series: time, energies, contacts, who came and left if the scene has
/// inlets, outlets or a domain, force and place of the walls, then what the scene measures.
template <int Dim>
std::vector<SeriesColumn> series_columns(const Run<Dim>& run);

/// The row of a run's series at this instant.
/// @param now         the run's ledger
/// @param statistics  of its contacts
template <int Dim>
Sample sample_of(const Run<Dim>& run, const Ledger& now, const ContactStatistics& statistics);

}  // namespace lagrain
