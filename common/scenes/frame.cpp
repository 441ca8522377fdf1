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
      for (int d = 0; d < kSpinDim<Dim>; ++d) {
        columns.push_back(
            {wall.name + ".torque" + (Dim == 2 ? "" : std::string(1, "xyz"[d])), "N m"});
      }
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
  const auto add = [&](const Vec<Dim>& v) { row.insert(row.end(), v.begin(), v.end()); };
  for (const Wall<Dim>& wall : run.walls()) {
    add(wall.force);
    if (wall.moves()) add(wall.point);
    if (wall.turns()) {
      row.push_back(wall.angle);
      row.insert(row.end(), wall.torque.begin(), wall.torque.end());
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
