// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How figures 1 to 4 draw discs, cells, edges, legends and magnified details, and how they write
/// their files. Everything is added to a display list; the state comes from geometry_scenes.hpp.

#include "geometry_scenes.hpp"

#include <lagrain/display_list.hpp>
#include <lagrain/style.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace lagrain::figures {

/// Edges, and those that carry a contact: thick and dark against thin, so that they differ in grey.
inline constexpr Stroke kEdgeLine{style::kEdge, 0.65};
inline constexpr Stroke kContactLine{style::kContact, 1.8};
inline constexpr Stroke kMissedLine{style::kEdgeGone, 1.4};
inline constexpr Stroke kNewLine{style::kEdgeNew, 2.4};
inline constexpr Stroke kMoveLine{style::kInk, 0.8};
/// Translucent: where discs overlap it is darker.
inline constexpr Colour kOverlapFill{130, 167, 218, 77};
/// Dash and gap of what is not there any more, or not found [pt].
inline const std::vector<double> kDashes{2.4, 3.2};

/// What is shown of some discs: where, and through which window of the world.
struct View {
  Panel panel;
  const Discs& discs;

  Vec<2> point(const Vec<2>& world) const { return panel.point(world); }
  Vec<2> centre(int i) const { return panel.point(discs.at(i)); }
  double radius(int i) const { return panel.length(discs.radius[i]); }
};

/// Laguerre cells of all sites that are not empty, cut to a panel's box, on the page.
std::vector<std::vector<Vec<2>>> cells_on_page(const Panel& panel,
                                               const Triangulation<2>& triangulation);

void add_fills(DisplayList& list, const View& view, Colour fill);
void add_outlines(DisplayList& list, const View& view, const Stroke& outline);
void add_sites(DisplayList& list, const View& view, double radius = 1.2);
void add_edges(DisplayList& list, const View& view, const std::vector<Pair>& edges,
               const Stroke& stroke);
void add_dashed_edges(DisplayList& list, const View& view, const std::vector<Pair>& edges,
                      const Stroke& stroke);
/// Edges thin, those with a contact thick, missed contacts dashed, and sites.
void add_triangulation(DisplayList& list, const View& view, const Found& found);
/// Cells cut to the view's box, their borders over translucent discs, and a frame.
void add_cells_and_discs(DisplayList& list, const View& view,
                         const Triangulation<2>& triangulation);
/// The numbers of the first discs, each at an offset from the disc's centre [pt].
void add_numbers(DisplayList& list, const View& view, const std::vector<Vec<2>>& offsets);
/// A ring around the point where two discs touch.
void add_ring(DisplayList& list, const View& view, Pair contact, double radius = 5);

/// Letter of a panel and what it shows, at the upper left of the box, above it.
void add_heading(DisplayList& list, const Box& box, const std::string& text);

/// Magnified window of a view, clipped to a frame on the page: cells, discs, edges. Circles and
/// edges may be far larger than the window.
struct Zoom {
  Box page;                ///< square [pt]
  Vec<2> middle;           ///< of the window [m]
  double width = 0;        ///< of the window [m]
  std::string label = {};  ///< below
};
void add_zoom(DisplayList& list, const Found& found, const Zoom& zoom);
/// A small square around a place of a picture, and lines from it to its magnified window on
/// the right.
void add_magnifier(DisplayList& list, const Vec<2>& at, double half, const Box& window);

/// A line of a legend.
struct LegendEntry {
  enum class Sample { line, dashes, ring, arrow } sample = Sample::line;
  Stroke stroke;
  std::string text;
};
/// Entries beside each other from `left` on; returns where the last ends [pt].
double add_legend_row(DisplayList& list, const Vec<2>& left, const std::vector<LegendEntry>& row);
double legend_width(const std::vector<LegendEntry>& row);
/// What the lines of T, its cells and its contacts mean, found and missed ones.
void add_detection_legend(DisplayList& list, const Vec<2>& left);

/// Arrow with an open head.
void add_arrow(DisplayList& list, const Vec<2>& from, const Vec<2>& to, const Stroke& stroke);

/// Writes NAME.png (300 dpi) and NAME.pdf into the folder.
void write_picture(const DisplayList& list, const std::filesystem::path& folder,
                   const std::string& name);

}  // namespace lagrain::figures
