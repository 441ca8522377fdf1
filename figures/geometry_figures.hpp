// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Figures 1 to 4: each is a state, a pure function from that state to a display list, and a
/// function that makes both, writes the files and reports.

#include "figure.hpp"
#include "geometry_scenes.hpp"

#include <lagrain/display_list.hpp>

#include <cstdint>
#include <utility>
#include <vector>

namespace lagrain::figures {

/// Figure 1: discs at rest, T and what touches.
struct Figure1 {
  Settled scene;
  Found contacts;
  int hull = 0;  ///< edges on the convex hull
};
Figure1 make_figure1();
Panel figure1_panel(const Figure1& figure);
DisplayList picture_of(const Figure1& figure);
FigureResult draw_figure1(const FigureOptions& options);

/// Figure 2: cells, edges and power; and the paper's misprint.
struct Figure2 {
  Found cells;              ///< S1 ... S4 are sites 0 ... 3
  Vec<2> x, tangent_point;  ///< P1(x) = |x - tangent_point|^2
  Found squares, roots;     ///< the same discs with weights r^2 and sqrt(r)
};
Figure2 make_figure2();
/// Where the tangent from x touches the circle; of the two points the one on the left, seen from x.
Vec<2> tangent_point(const Vec<2>& centre, double radius, const Vec<2>& x);
DisplayList picture_of(const Figure2& figure);
FigureResult draw_figure2(const FigureOptions& options);

/// Figure 3: overlapping discs, and four equal ones where T just finds, just misses a contact.
struct Figure3 {
  Found overlapping;
  Found below, above;  ///< squares of four unit discs
};
Figure3 make_figure3();
/// Four unit discs at (+-0.9999, 0) and (0, +-y).
Discs square_of_discs(double y);
DisplayList picture_of(const Figure3& figure);
FigureResult draw_figure3(const FigureOptions& options);

/// Figure 4: T before a move, what its edges find after it, and T maintained.
struct Figure4 {
  std::uint64_t seed = 0;
  double side = 0;                         ///< of the box [m]
  double before_time = 0, after_time = 0;  ///< [s]
  Discs before;
  std::vector<Pair> stale;  ///< edges before, sorted
  std::vector<Pair> contacts_before;
  Found after;           ///< T maintained: moved from `before`
  Pair gone, fresh;      ///< the edge that disappears, the edge that appears
  UpdateReport update;   ///< what the move cost
  double mean_move = 0;  ///< over the mean radius [-]
};
/// Takes the first seed, and in it the longest move of at least half a mean radius, such that T
/// changes by exactly one edge for another, which crosses it clearly and carries a contact that is
/// on no old edge, while another contact stays found.
Figure4 make_figure4();
DisplayList picture_of(const Figure4& figure);

/// What the video shows at one instant.
struct FilmFrame {
  Discs discs;
  double time = 0;  ///< [s]
  std::vector<Pair> edges;
  std::vector<std::pair<Pair, double>> fresh;    ///< edge, time since it appeared [s]
  std::vector<std::pair<Pair, double>> gone;     ///< edge, time since it disappeared [s]
  std::vector<std::pair<Pair, double>> touched;  ///< edge, time since its discs last touched [s]
  std::int64_t flips = 0;                        ///< so far
  std::int64_t contacts = 0;                     ///< collisions between discs so far
  std::int64_t missed = 0;                       ///< of these, on no edge of T
  std::int64_t missed_by_first = 0;              ///< of these, on no edge of T as it was at time 0
};
/// Maintains T by moves, snapshot by snapshot, and keeps every `every`-th.
std::vector<FilmFrame> film(const Flight& flight, int every);
DisplayList picture_of(const FilmFrame& frame, double side);

FigureResult draw_figure4(const FigureOptions& options);

}  // namespace lagrain::figures
