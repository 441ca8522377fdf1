// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry_drawing.hpp"

#include <lagrain/laguerre2.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/plot.hpp>
#include <lagrain/text.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lagrain::figures {
namespace {

constexpr double kSample = 15;   // length of a legend's sample [pt]
constexpr double kGap = 4;       // between sample and text [pt]
constexpr double kBetween = 12;  // between entries [pt]

/// The part of a convex polygon on the left of the line through p along `direction`.
std::vector<Vec<2>> left_of(const std::vector<Vec<2>>& polygon, const Vec<2>& p,
                            const Vec<2>& direction) {
  const auto side = [&](const Vec<2>& x) {
    return direction[0] * (x[1] - p[1]) - direction[1] * (x[0] - p[0]);
  };
  std::vector<Vec<2>> part;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec<2>& a = polygon[k];
    const Vec<2>& b = polygon[(k + 1) % polygon.size()];
    const double sa = side(a), sb = side(b);
    if (sa >= 0) part.push_back(a);
    if ((sa > 0 && sb < 0) || (sa < 0 && sb > 0)) part.push_back(a + sa / (sa - sb) * (b - a));
  }
  return part;
}

/// The part of a disc inside a box, and the arc that bounds it there. Made in double precision, for
/// discs far larger than the box.
struct CutDisc {
  std::vector<Vec<2>> area;
  std::vector<Vec<2>> arc;
};
CutDisc cut_disc(const Vec<2>& centre, double radius, const Box& box) {
  const Vec<2> towards = box.centre() - centre;
  const double reach = std::min(std::numbers::pi, 2 * box.size().norm() / radius);
  const double middle = std::atan2(towards[1], towards[0]);
  const auto on_circle = [&](double angle) {
    return Vec<2>(centre + radius * Vec<2>(std::cos(angle), std::sin(angle)));
  };
  CutDisc cut;
  constexpr int kFine = 200, kCoarse = 60;
  for (int k = 0; k <= kFine; ++k) {
    const double angle = middle - reach + 2 * reach * k / kFine;
    cut.area.push_back(on_circle(angle));
    cut.arc.push_back(on_circle(angle));
  }
  for (int k = 1; k < kCoarse; ++k) {
    cut.area.push_back(on_circle(middle + reach + 2 * (std::numbers::pi - reach) * k / kCoarse));
  }
  cut.area = left_of(cut.area, box.low, {1, 0});
  cut.area = left_of(cut.area, box.high, {-1, 0});
  cut.area = left_of(cut.area, box.high, {0, 1});
  cut.area = left_of(cut.area, box.low, {0, -1});
  return cut;
}

Eigen::AlignedBox2d world_of(const Panel& panel) {
  const Vec<2> origin = panel.point(Vec<2>::Zero());
  return {(panel.box().low - origin) / panel.scale(), (panel.box().high - origin) / panel.scale()};
}

}  // namespace

std::vector<std::vector<Vec<2>>> cells_on_page(const Panel& panel,
                                               const Triangulation<2>& triangulation) {
  std::vector<std::vector<Vec<2>>> cells;
  for (int i = 0; i < triangulation.size(); ++i) {
    const Columns<2> cell = laguerre_cell(triangulation, i, world_of(panel));
    if (cell.cols() < 3) continue;
    cells.emplace_back();
    for (Eigen::Index k = 0; k < cell.cols(); ++k) cells.back().push_back(panel.point(cell.col(k)));
  }
  return cells;
}

void add_fills(DisplayList& list, const View& view, Colour fill) {
  for (int i = 0; i < view.discs.size(); ++i) {
    list.add(Disc{.centre = view.centre(i), .radius = view.radius(i), .fill = fill});
  }
}

void add_outlines(DisplayList& list, const View& view, const Stroke& outline) {
  for (int i = 0; i < view.discs.size(); ++i) {
    list.add(Disc{.centre = view.centre(i), .radius = view.radius(i), .outline = outline});
  }
}

void add_sites(DisplayList& list, const View& view, double radius) {
  for (int i = 0; i < view.discs.size(); ++i) {
    list.add(Disc{.centre = view.centre(i), .radius = radius, .fill = style::kInk});
  }
}

void add_edges(DisplayList& list, const View& view, const std::vector<Pair>& edges,
               const Stroke& stroke) {
  for (const auto& [i, j] : edges) list.add(Segment{view.centre(i), view.centre(j), stroke});
}

void add_dashed_edges(DisplayList& list, const View& view, const std::vector<Pair>& edges,
                      const Stroke& stroke) {
  for (const auto& [i, j] : edges) {
    list.add(Polyline{{view.centre(i), view.centre(j)}, stroke, kDashes});
  }
}

void add_triangulation(DisplayList& list, const View& view, const Found& found) {
  add_edges(list, view, without(found.edges, found.found), kEdgeLine);
  add_edges(list, view, found.found, kContactLine);
  add_dashed_edges(list, view, found.missed, kMissedLine);
  add_sites(list, view);
}

void add_cells_and_discs(DisplayList& list, const View& view,
                         const Triangulation<2>& triangulation) {
  const auto cells = cells_on_page(view.panel, triangulation);
  list.add(PushClip{view.panel.box()});
  for (const auto& cell : cells) list.add(Polygon{.corners = cell, .fill = style::kCell});
  add_fills(list, view, kOverlapFill);
  for (const auto& cell : cells) list.add(Polygon{.corners = cell, .outline = style::kCellLine});
  add_outlines(list, view, style::kGrainLine);
  list.add(PopClip{});
  add_frame(list, view.panel.box(), style::kCellLine);
}

void add_numbers(DisplayList& list, const View& view, const std::vector<Vec<2>>& offsets) {
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    list.add(Label{.text = std::to_string(i),
                   .at = view.centre(static_cast<int>(i)) + offsets[i],
                   .size = style::kSmallText,
                   .colour = style::kInk,
                   .across = Across::centre,
                   .along = Along::middle});
  }
}

void add_ring(DisplayList& list, const View& view, Pair contact, double radius) {
  const Vec<2> a = view.centre(contact.i), b = view.centre(contact.j);
  const Vec<2> touch = a + (b - a).normalized() * view.radius(contact.i);
  list.add(Disc{.centre = touch, .radius = radius, .outline = kMissedLine});
}

void add_heading(DisplayList& list, const Box& box, const std::string& text) {
  list.add(Label{.text = text,
                 .at = {box.low[0], box.high[1] + 4},
                 .size = style::kText,
                 .colour = style::kInk});
}

void add_zoom(DisplayList& list, const Found& found, const Zoom& zoom) {
  const Vec<2> half = Vec<2>::Constant(0.5 * zoom.width);
  const Box window{zoom.middle - half, zoom.middle + half};
  const Panel panel(zoom.page, window);
  const auto cells = cells_on_page(panel, found.triangulation);
  list.add(PushClip{panel.box()});
  for (const auto& cell : cells) list.add(Polygon{.corners = cell, .fill = style::kCell});
  std::vector<CutDisc> cuts;
  for (int i = 0; i < found.discs.size(); ++i) {
    CutDisc cut = cut_disc(found.discs.at(i), found.discs.radius[i], window);
    if (cut.area.size() < 3) continue;
    for (Vec<2>& p : cut.area) p = panel.point(p);
    for (Vec<2>& p : cut.arc) p = panel.point(p);
    cuts.push_back(std::move(cut));
  }
  for (const CutDisc& cut : cuts) list.add(Polygon{.corners = cut.area, .fill = kOverlapFill});
  for (const auto& cell : cells) list.add(Polygon{.corners = cell, .outline = style::kCellLine});
  for (const CutDisc& cut : cuts) list.add(Polyline{cut.arc, style::kGrainLine});
  const auto add_lines = [&](const std::vector<Pair>& pairs, const Stroke& stroke,
                             const std::vector<double>& dashes) {
    for (const auto& [i, j] : pairs) {
      const Vec<2> along = (found.discs.at(j) - found.discs.at(i)).normalized();
      const Vec<2> from = found.discs.at(i);
      const Vec<2> foot = from + (zoom.middle - from).dot(along) * along;
      if (!window.contains(foot)) continue;
      list.add(
          Polyline{{panel.point(foot - zoom.width * along), panel.point(foot + zoom.width * along)},
                   stroke,
                   dashes});
    }
  };
  add_lines(without(found.edges, found.found), kEdgeLine, {});
  add_lines(found.found, kContactLine, {});
  add_lines(found.missed, kMissedLine, kDashes);
  list.add(PopClip{});
  add_frame(list, panel.box());
  list.add(Label{.text = zoom.label,
                 .at = {panel.box().centre()[0], panel.box().low[1] - 4},
                 .size = style::kSmallText,
                 .colour = style::kInk,
                 .across = Across::centre,
                 .along = Along::top});
}

void add_magnifier(DisplayList& list, const Vec<2>& at, double half, const Box& window) {
  const Vec<2> corner = Vec<2>::Constant(half);
  const Stroke line{style::kInk, style::kHairline};
  list.add(Segment{at + corner, {window.low[0], window.high[1]}, line});
  list.add(Segment{at + Vec<2>(half, -half), window.low, line});
  list.add(Polygon{.corners = corners({at - corner, at + corner}), .outline = style::kAxisLine});
}

double legend_width(const std::vector<LegendEntry>& row) {
  double width = 0;
  for (const LegendEntry& entry : row) {
    if (width > 0) width += kBetween;
    width += kSample + kGap + text_extents(entry.text, style::kSmallText).advance;
  }
  return width;
}

double add_legend_row(DisplayList& list, const Vec<2>& left, const std::vector<LegendEntry>& row) {
  double x = left[0];
  for (const LegendEntry& entry : row) {
    const Vec<2> a(x, left[1]), b(x + kSample, left[1]);
    switch (entry.sample) {
      case LegendEntry::Sample::line:
        list.add(Segment{a, b, entry.stroke});
        break;
      case LegendEntry::Sample::dashes:
        list.add(Polyline{{a, b}, entry.stroke, kDashes});
        break;
      case LegendEntry::Sample::ring:
        list.add(Disc{.centre = 0.5 * (a + b), .radius = 4, .outline = entry.stroke});
        break;
      case LegendEntry::Sample::arrow:
        add_arrow(list, a, b, entry.stroke);
        break;
    }
    const Label label{.text = entry.text,
                      .at = {x + kSample + kGap, left[1]},
                      .size = style::kSmallText,
                      .colour = style::kInk,
                      .along = Along::middle};
    list.add(label);
    x += kSample + kGap + text_extents(entry.text, style::kSmallText).advance + kBetween;
  }
  return x - kBetween;
}

void add_detection_legend(DisplayList& list, const Vec<2>& left) {
  using enum LegendEntry::Sample;
  add_legend_row(list, left,
                 {{line, kEdgeLine, "edge of T"},
                  {line, style::kCellLine, "between cells"},
                  {line, kContactLine, "edge with a contact"},
                  {dashes, kMissedLine, "contact without an edge"}});
}

void add_arrow(DisplayList& list, const Vec<2>& from, const Vec<2>& to, const Stroke& stroke) {
  const double length = (to - from).norm();
  if (length == 0) return;
  const Vec<2> along = (to - from) / length, across(-along[1], along[0]);
  const double head = std::min(3.5, 0.6 * length);
  list.add(Segment{from, to, stroke});
  list.add(Segment{to, to - head * (along + 0.5 * across), stroke});
  list.add(Segment{to, to - head * (along - 0.5 * across), stroke});
}

void write_picture(const DisplayList& list, const std::filesystem::path& folder,
                   const std::string& name) {
  paint_png(list, folder / (name + ".png"));
  paint_pdf(list, folder / (name + ".pdf"));
}

}  // namespace lagrain::figures
