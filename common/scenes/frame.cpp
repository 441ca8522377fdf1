// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/frame.hpp>

#include "measure.hpp"

namespace lagrain {

template <int Dim>
std::vector<SeriesColumn> series_columns(const Run<Dim>& run) {
  std::vector<SeriesColumn> columns{{"time", "s"},
                                    {"kinetic", "J"},
                                    {"gravity", "J"},
                                    {"elastic", "J"},
                                    {"wall_work", "J"},
                                    {"dashpot", "J"},
                                    {"friction", "J"},
                                    {"residual", "J"},
                                    {"contacts", "-"},
                                    {"wall_contacts", "-"},
                                    {"coordination", "-"},
                                    {"mean_overlap", "-"},
                                    {"largest_overlap", "-"},
                                    {"near_pairs", "-"},
                                    {"refreshes", "-"}};
  const auto add = [&](const std::string& stem, const char* unit) {
    for (int d = 0; d < Dim; ++d) columns.push_back({stem + "xyz"[d], unit});
  };
  const auto add_spin = [&](const std::string& stem, const char* unit) {
    for (int d = 0; d < kSpinDim<Dim>; ++d) {
      columns.push_back({stem + (Dim == 2 ? "" : std::string(1, "xyz"[d])), unit});
    }
  };
  if (!is_steady(run.scene().gravity_course)) columns.push_back({"gravity_work", "J"});
  if (run.scene().drag) columns.push_back({"drag_work", "J"});
  if (run.drives()) {
    columns.push_back({"driven_work", "J"});
    add("driven.f", "N");
    if (run.spins() != nullptr) add_spin("driven.torque", "N m");
  }
  if (run.traffic() != nullptr) {
    columns.push_back({"carried", "J"});
    columns.push_back({"grains", "-"});
    for (const Inlet<Dim>& inlet : run.scene().inlets) columns.push_back({inlet.name + ".in", "-"});
    for (const Outlet<Dim>& outlet : run.scene().outlets) {
      columns.push_back({outlet.name + ".out", "-"});
      columns.push_back({outlet.name + ".mass", "kg"});
    }
    if (run.scene().domain) columns.push_back({"domain.out", "-"});
  }
  for (const Wall<Dim>& wall : run.walls()) {
    add(wall.name + ".f", "N");
    if (wall.moves()) add(wall.name + ".", "m");
    if (wall.turns()) {
      columns.push_back({wall.name + ".angle", "rad"});
      add_spin(wall.name + ".torque", "N m");
    }
    if (wall.turns() || wall.runs()) columns.push_back({wall.name + ".work", "J"});
  }
  detail::add_measure_columns(run.scene(), columns);
  return columns;
}

template <int Dim>
Sample sample_of(const Run<Dim>& run, const Ledger& now, const ContactStatistics& s) {
  Sample row{run.time(),        now.kinetic,
             now.gravity,       now.elastic,
             now.wall_work,     now.dashpot,
             now.friction,      residual(now, run.start()),
             s.contacts,        s.wall_contacts,
             s.coordination,    s.mean_overlap,
             s.largest_overlap, static_cast<std::int64_t>(run.near_pairs().size()),
             run.refreshes()};
  const auto add = [&](const auto& v) { row.insert(row.end(), v.begin(), v.end()); };
  if (!is_steady(run.scene().gravity_course)) row.emplace_back(now.gravity_work);
  if (run.scene().drag) row.emplace_back(now.force_work);
  if (run.drives()) {
    row.emplace_back(now.driven_work);
    add(run.driven().force);
    if (run.spins() != nullptr) add(run.driven().torque);
  }
  if (const TrafficCounts* traffic = run.traffic()) {
    row.emplace_back(now.carried);
    row.emplace_back(std::int64_t{run.count()});
    for (const auto& in : traffic->inlets) row.emplace_back(in.grains);
    for (const auto& out : traffic->outlets) {
      row.emplace_back(out.grains);
      row.emplace_back(out.mass);
    }
    if (run.scene().domain) row.emplace_back(traffic->lost);
  }
  for (const Wall<Dim>& wall : run.walls()) {
    add(wall.force);
    if (wall.moves()) add(wall.point);
    if (wall.turns()) {
      row.push_back(wall.angle);
      add(wall.torque);
    }
    if (wall.turns() || wall.runs()) row.push_back(wall.work);
  }
  detail::add_measures(run, row);
  return row;
}

template std::vector<SeriesColumn> series_columns<2>(const Run<2>&);
template std::vector<SeriesColumn> series_columns<3>(const Run<3>&);
template Sample sample_of<2>(const Run<2>&, const Ledger&, const ContactStatistics&);
template Sample sample_of<3>(const Run<3>&, const Ledger&, const ContactStatistics&);

}  // namespace lagrain
