// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 4 of the paper: "As the spheres move, the original Delaunay triangulation may fail to
// detect contacts. Maintaining the triangulation is mandatory: a new edge appears while another one
// disappears." Discs fly and collide in a box. (a) T and the discs; (b) the discs after a move with
// the old edges, which miss a contact; (c) T moved along: one edge has gone, and the new one
// carries that contact. A video shows T maintained from frame to frame.
//
// Writes fig4.png, fig4.pdf, fig4.mp4 (or a folder of frames), fig4_discs.csv, fig4_edges.csv
// and fig4_film.csv.

#include "geometry_drawing.hpp"
#include "geometry_figures.hpp"

#include <lagrain/check.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/plot.hpp>
#include <lagrain/run.hpp>
#include <lagrain/text.hpp>
#include <lagrain/video.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>

namespace lagrain::figures {
namespace {

constexpr int kCount = 16;
constexpr double kFlight = 1;  // searched of each seed [s]
constexpr std::uint64_t kSeeds = 200;
constexpr double kLeastMove = 0.5;  // of the mean radius, mean over the discs

constexpr double kMargin = 3;    // around everything [pt]
constexpr double kHeading = 15;  // above a panel [pt]
constexpr double kLegend = 32;   // below the panels [pt]
constexpr double kBetween = 12;  // panels [pt]

constexpr double kFade = 0.12;  // of what appears or disappears in the video [s]

std::vector<int> everybody(int count) {
  std::vector<int> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

double mean_move(const Columns<2>& from, const Columns<2>& to) {
  return (to - from).colwise().norm().mean();
}

/// Snapshots `before` and `after`, and the edges that were exchanged.
struct Exchange {
  std::size_t before = 0, after = 0;
  Pair gone, fresh;
  double move = 0;  ///< [m]
};

/// True if the segments cross well inside both, so that a reader can tell them apart.
bool cross_clearly(const Discs& discs, Pair a, Pair b) {
  constexpr double kInside = 0.2;
  Eigen::Matrix2d ends;
  ends << discs.at(a.j) - discs.at(a.i), discs.at(b.i) - discs.at(b.j);
  const Vec<2> t = ends.inverse() * (discs.at(b.i) - discs.at(a.i));  // of the way along each
  return t.minCoeff() > kInside && t.maxCoeff() < 1 - kInside;
}

std::optional<Exchange> find_exchange(const Flight& flight) {
  std::vector<std::vector<Pair>> edges, contacts;
  for (std::size_t k = 0; k < flight.centres.size(); ++k) {
    const Found found = find_contacts(flight.discs(k));
    edges.push_back(found.edges);
    contacts.push_back(found.found);
    contacts.back().insert(contacts.back().end(), found.missed.begin(), found.missed.end());
    std::sort(contacts.back().begin(), contacts.back().end());
  }
  std::optional<Exchange> best;
  double longest = kLeastMove * flight.radius.mean();
  for (std::size_t after = 0; after < edges.size(); ++after) {
    // Two contacts: one that the old edges still find, for comparison, and one that they miss.
    if (contacts[after].size() < 2) continue;
    for (std::size_t before = 0; before < after; ++before) {
      const std::vector<Pair> fresh = without(edges[after], edges[before]);
      if (fresh.size() != 1 || without(contacts[after], edges[before]) != fresh) continue;
      const std::vector<Pair> gone = without(edges[before], edges[after]);
      if (gone.size() != 1) continue;
      const double move = mean_move(flight.centres[before], flight.centres[after]);
      if (move <= longest || !cross_clearly(flight.discs(after), gone.front(), fresh.front())) {
        continue;
      }
      longest = move;
      best = Exchange{before, after, gone.front(), fresh.front(), move};
    }
  }
  return best;
}

void add_box(DisplayList& list, const Panel& panel) {
  Box box = panel.box();
  const Vec<2> out = Vec<2>::Constant(0.5 * style::kWallLine.width);
  box = {box.low - out, box.high + out};
  add_frame(list, box, style::kWallLine);
}

Colour faded(Colour from, Colour to, double age) {
  return mix(from, to, std::clamp(age / kFade, 0.0, 1.0));
}

}  // namespace

Figure4 make_figure4() {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Flight flight = fly(kCount, seed, kFlight, 4 * kLeastInterval);
    const std::optional<Exchange> exchange = find_exchange(flight);
    if (!exchange) continue;
    const Found before = find_contacts(flight.discs(exchange->before));
    Figure4 figure{.seed = seed,
                   .side = flight.side,
                   .before_time = static_cast<double>(exchange->before) * flight.interval,
                   .after_time = static_cast<double>(exchange->after) * flight.interval,
                   .before = before.discs,
                   .stale = before.edges,
                   .contacts_before = before.found,
                   .after = before,
                   .gone = exchange->gone,
                   .fresh = exchange->fresh,
                   .update = {},
                   .mean_move = exchange->move / flight.radius.mean()};
    // T is not built anew: it is moved.
    Found& after = figure.after;
    after.discs = flight.discs(exchange->after);
    figure.update = after.triangulation.move(everybody(kCount), after.discs.centre,
                                             after.discs.radius.array().square());
    after.edges = edges_of(after.triangulation);
    const std::vector<Pair> contacts = contacts_of(after.discs);
    after.missed = without(contacts, after.edges);
    after.found = without(contacts, after.missed);
    return figure;
  }
  throw SimulationError("figure 4: no seed up to " + std::to_string(kSeeds) +
                        " exchanges one edge for one that carries a new contact");
}

DisplayList picture_of(const Figure4& figure) {
  const double side = (style::kPage - 2 * kMargin - 2 * kBetween) / 3;
  const double bottom = kMargin + kLegend;
  DisplayList list{.width = style::kPage,
                   .height = bottom + side + kHeading,
                   .title = "Moving discs: the triangulation before, stale, and maintained"};
  const auto panel = [&](int k) {
    const Vec<2> low(kMargin + k * (side + kBetween), bottom);
    return Panel({low, low + Vec<2>(side, side)}, {{0, 0}, {figure.side, figure.side}});
  };
  const auto add_panel = [&](const View& view, const std::vector<Pair>& edges,
                             const std::vector<Pair>& contacts, const std::string& text) {
    add_fills(list, view, style::kGrain);
    add_outlines(list, view, style::kGrainLine);
    add_edges(list, view, without(edges, contacts), kEdgeLine);
    add_edges(list, view, contacts, kContactLine);
    add_box(list, view.panel);
    add_heading(list, view.panel.box(), text);
  };
  const std::vector<Pair>& contacts = figure.after.found;

  const View before{panel(0), figure.before};
  add_panel(before, figure.stale, figure.contacts_before,
            "(a) $t = " + fixed(1e3 * figure.before_time, 0) + "$ ms: T");
  for (int i = 0; i < figure.before.size(); ++i) {
    add_arrow(list, before.centre(i), before.point(figure.after.discs.at(i)), kMoveLine);
  }
  add_sites(list, before);

  const View stale{panel(1), figure.after.discs};
  const std::vector<Pair> missed = without(contacts, figure.stale);
  add_panel(stale, figure.stale, without(contacts, missed),
            "(b) $t = " + fixed(1e3 * figure.after_time, 0) + "$ ms: T stale");
  for (const Pair& pair : missed) add_ring(list, stale, pair, 6);
  add_sites(list, stale);

  const View maintained{panel(2), figure.after.discs};
  add_panel(maintained, figure.after.edges, without(contacts, missed),
            "(c) $t = " + fixed(1e3 * figure.after_time, 0) + "$ ms: T maintained");
  add_dashed_edges(list, maintained, {figure.gone}, kMissedLine);
  add_edges(list, maintained, {figure.fresh}, kNewLine);
  add_sites(list, maintained);

  using enum LegendEntry::Sample;
  add_legend_row(list, {kMargin, kMargin + 18},
                 {{line, kEdgeLine, "edge"},
                  {line, kContactLine, "edge with a contact"},
                  {arrow, kMoveLine, "move from (a) to (b)"},
                  {ring, kMissedLine, "contact without an edge"}});
  add_legend_row(list, {kMargin, kMargin + 5},
                 {{line, kNewLine, "edge that has appeared, with the contact"},
                  {dashes, kMissedLine, "edge that has disappeared"}});
  add_scale_bar(list, {panel(2).box().high[0] - panel(2).length(0.05), kMargin + 8}, panel(2), 0.05,
                "5 cm");
  return list;
}

std::vector<FilmFrame> film(const Flight& flight, int every) {
  std::vector<FilmFrame> frames;
  std::map<Pair, double> appeared, vanished, touched;
  std::vector<Pair> before_contacts;
  FilmFrame now;
  Found first = find_contacts(flight.discs(0));
  Triangulation<2>& triangulation = first.triangulation;
  const Eigen::VectorXd weights = flight.radius.array().square();
  const std::vector<int> all = everybody(static_cast<int>(flight.radius.size()));
  now.edges = first.edges;
  for (std::size_t k = 0; k < flight.centres.size(); ++k) {
    now.discs = flight.discs(k);
    now.time = static_cast<double>(k) * flight.interval;
    now.flips += triangulation.move(all, now.discs.centre, weights).flips;
    const std::vector<Pair> edges = edges_of(triangulation);
    for (const Pair& edge : without(edges, now.edges)) {
      appeared[edge] = now.time;
      vanished.erase(edge);
    }
    for (const Pair& edge : without(now.edges, edges)) {
      vanished[edge] = now.time;
      appeared.erase(edge);
    }
    now.edges = edges;
    const std::vector<Pair> contacts = contacts_of(now.discs);
    for (const Pair& pair : contacts) touched[pair] = now.time;
    const std::vector<Pair> collisions = without(contacts, before_contacts);
    now.contacts += static_cast<std::int64_t>(collisions.size());
    now.missed += static_cast<std::int64_t>(without(collisions, edges).size());
    now.missed_by_first += static_cast<std::int64_t>(without(collisions, first.edges).size());
    before_contacts = contacts;
    if (k % static_cast<std::size_t>(every) != 0) continue;
    const auto recent = [&](const std::map<Pair, double>& since) {
      std::vector<std::pair<Pair, double>> ages;
      for (const auto& [pair, time] : since) {
        if (now.time - time < kFade) ages.push_back({pair, now.time - time});
      }
      return ages;
    };
    now.fresh = recent(appeared);
    now.gone = recent(vanished);
    now.touched = recent(touched);
    frames.push_back(now);
  }
  return frames;
}

DisplayList picture_of(const FilmFrame& frame, double side) {
  constexpr double kHeight = 360, kWidth = 520, kBox = 340, kEdge = 10;  // [pt]
  DisplayList list{.width = kWidth, .height = kHeight};
  const Panel panel({{kEdge, kEdge}, {kEdge + kBox, kEdge + kBox}}, {{0, 0}, {side, side}});
  const View view{panel, frame.discs};
  add_fills(list, view, style::kGrain);
  add_outlines(list, view, style::kGrainLine);
  add_edges(list, view, frame.edges, {style::kEdge, 1.0});
  for (const auto& [edge, age] : frame.gone) {
    const double left = 1 - age / kFade;
    add_dashed_edges(list, view, {edge}, {with_alpha(style::kEdgeGone, left), 1.6});
  }
  for (const auto& [edge, age] : frame.fresh) {
    add_edges(list, view, {edge},
              {faded(style::kEdgeNew, style::kEdge, age),
               std::lerp(3.5, 1.0, std::min(age / kFade, 1.0))});
  }
  for (const auto& [pair, age] : frame.touched) {
    if (!holds(frame.edges, pair)) continue;
    add_edges(list, view, {pair}, {with_alpha(style::kContact, 1 - age / kFade), 4.5});
  }
  add_sites(list, view, 1.8);
  add_box(list, panel);

  const double x = kEdge + kBox + 16;
  double y = kHeight - 22;
  const auto row = [&](const std::string& text, const std::string& value) {
    list.add(Label{.text = text, .at = {x, y}, .size = 12, .colour = style::kInk});
    list.add(Label{.text = value,
                   .at = {kWidth - 12, y},
                   .size = 12,
                   .colour = style::kInk,
                   .across = Across::right});
    y -= 18;
  };
  row("time", fixed(frame.time, 3) + " s");
  row("flips", std::to_string(frame.flips));
  y -= 12;
  row("collisions", std::to_string(frame.contacts));
  row("missed by T", std::to_string(frame.missed));
  row("by T of time 0", std::to_string(frame.missed_by_first));

  y = kEdge + 60;
  const auto sample = [&](const Stroke& stroke, bool dashes, const std::string& text) {
    const Vec<2> a(x + 2, y + 4), b(x + 26, y + 4);
    list.add(Polyline{{a, b}, stroke, dashes ? kDashes : std::vector<double>{}});
    list.add(Label{.text = text, .at = {x + 36, y}, .size = 12, .colour = style::kInk});
    y -= 18;
  };
  sample({style::kEdge, 1.0}, false, "edge of T");
  sample({style::kContact, 4.5}, false, "contact");
  sample({style::kEdgeNew, 3.5}, false, "appears");
  sample({style::kEdgeGone, 1.6}, true, "disappears");
  return list;
}

namespace {

void write_tables(const Figure4& figure, const std::filesystem::path& folder) {
  std::vector<std::vector<double>> discs, edges;
  for (int i = 0; i < figure.before.size(); ++i) {
    discs.push_back({static_cast<double>(i), figure.before.radius[i], figure.before.at(i)[0],
                     figure.before.at(i)[1], figure.after.discs.at(i)[0],
                     figure.after.discs.at(i)[1]});
  }
  std::set<Pair> either(figure.stale.begin(), figure.stale.end());
  either.insert(figure.after.edges.begin(), figure.after.edges.end());
  for (const Pair& edge : either) {
    edges.push_back({static_cast<double>(edge.i), static_cast<double>(edge.j),
                     holds(figure.stale, edge) ? 1.0 : 0.0,
                     holds(figure.after.edges, edge) ? 1.0 : 0.0,
                     figure.after.discs.overlap(edge)});
  }
  write_csv(folder / "fig4_discs.csv", "disc[-],r[m],x_before[m],y_before[m],x_after[m],y_after[m]",
            discs);
  write_csv(folder / "fig4_edges.csv", "i[-],j[-],before[-],after[-],overlap_after[m]", edges);
}

/// Writes what the video counts, frame by frame.
void write_film_table(const std::vector<FilmFrame>& frames, const std::filesystem::path& folder) {
  std::vector<std::vector<double>> counts;
  for (const FilmFrame& frame : frames) {
    counts.push_back({frame.time, static_cast<double>(frame.flips),
                      static_cast<double>(frame.contacts), static_cast<double>(frame.missed),
                      static_cast<double>(frame.missed_by_first)});
  }
  write_csv(folder / "fig4_film.csv", "time[s],flips[-],collisions[-],missed[-],missed_by_first[-]",
            counts);
}

/// Plays the flight at a quarter of its speed.
/// @throws Interrupted
VideoReport write_film(const std::vector<FilmFrame>& frames, double side,
                       const FigureOptions& options) {
  constexpr int kFramesPerSecond = 30;
  VideoWriter video(options.out / "fig4.mp4", kFramesPerSecond);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    options.check_stop();
    options.progress(static_cast<double>(k) / static_cast<double>(frames.size()), "video");
    video.add(paint_rgba(picture_of(frames[k], side), 144, Quality::frame));
  }
  return video.finish();
}

/// @param last  frame of the video
std::string caption_of(const FilmFrame& last) {
  return std::to_string(kCount) +
         " discs that fly and collide elastically in a box. (a) The discs and their regular "
         "triangulation T; arrows: the move that follows. (b) After the move, the edges of (a): "
         "one contact lies on no edge (ring) and would be missed. (c) T moved with the discs: one "
         "edge has disappeared, the one that appeared carries the contact. Chosen by search: the "
         "first seed, and in it the longest move of at least half the mean radius, that exchanges "
         "exactly one edge for one that crosses it clearly and carries a contact, while another "
         "contact stays found. Video: T maintained, " +
         std::to_string(last.flips) + " flips in " + rounded(last.time, 3) + " s; " +
         std::to_string(last.contacts) + " collisions, of which T misses " +
         std::to_string(last.missed) + " and T of time 0 would miss " +
         std::to_string(last.missed_by_first) + ".";
}

std::vector<Comparison> comparisons_of(const Figure4& figure) {
  const auto name = [](Pair pair) { return std::to_string(pair.i) + "-" + std::to_string(pair.j); };
  return {
      {"edges that appear, disappear", "one, another one",
       name(figure.fresh) + ", " + name(figure.gone)},
      {"contacts missed by the old T", "may fail to detect contacts",
       std::to_string(without(figure.after.found, figure.stale).size()) + " of " +
           std::to_string(figure.after.found.size())},
      {"contacts missed by the maintained T", "none", std::to_string(figure.after.missed.size())}};
}

/// @param flight  of the video
std::vector<Fact> facts_of(const Figure4& figure, const Flight& flight) {
  return {{"seed", std::to_string(figure.seed)},
          {"move", "from " + fixed(1e3 * figure.before_time, 0) + " to " +
                       fixed(1e3 * figure.after_time, 0) + " ms; mean " +
                       rounded(figure.mean_move, 2) + " of the mean radius"},
          {"that move", std::to_string(figure.update.flips) + " flips, " +
                            std::to_string(figure.update.extracted + figure.update.unstuck) +
                            " sites taken out and put back"},
          {"largest overlap in the video",
           rounded(100 * flight.largest_overlap, 2) + " % of the smaller radius"},
          {"energy drift in the video", rounded(100 * flight.energy_drift, 2) + " %"}};
}

}  // namespace

FigureResult draw_figure4(const FigureOptions& options) {
  options.progress(0, "searching a move that exchanges one edge");
  const Figure4 figure = make_figure4();
  write_picture(picture_of(figure), options.out, "fig4");
  write_tables(figure, options.out);

  // The video shows the same discs from time 0 on.
  constexpr int kEvery = 16;  // snapshots to a frame
  const Flight flight = fly(kCount, figure.seed, options.quick ? 0.5 : 2.0, kLeastInterval);
  const std::vector<FilmFrame> frames = film(flight, kEvery);
  const VideoReport video = write_film(frames, flight.side, options);
  write_film_table(frames, options.out);

  FigureResult result;
  result.caption = caption_of(frames.back());
  result.comparisons = comparisons_of(figure);
  result.facts = facts_of(figure, flight);
  result.pictures = {"fig4.png", video.path};
  result.downloads = {"fig4.pdf", "fig4_discs.csv", "fig4_edges.csv", "fig4_film.csv"};
  return result;
}

}  // namespace lagrain::figures
