// SPDX-License-Identifier: GPL-3.0-or-later
#include "teach_pictures.hpp"

#include "geometry_drawing.hpp"
#include "geometry_figures.hpp"
#include "teach/lab.hpp"
#include "teach_numbers.hpp"

#include <lagrain/check.hpp>
#include <lagrain/plot.hpp>
#include <lagrain/random.hpp>
#include <lagrain/skins.hpp>
#include <lagrain/words.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

namespace lagrain::figures {
namespace {

constexpr double kWidth = 420;  // of a picture [pt]
constexpr double kMargin = 6;   // around it [pt]

using Row = std::vector<double>;

/// A key of a start as a list of lists of numbers.
std::vector<Row> rows_of(const toml::table& start, const char* key) {
  std::vector<Row> rows;
  const toml::array* list = start[key].as_array();
  if (list == nullptr) return rows;
  for (const auto& item : *list) {
    Row row;
    if (const toml::array* numbers = item.as_array()) {
      for (const auto& number : *numbers) row.push_back(number.value_or(0.0));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}
Row row_of(const toml::table& start, const char* key) {
  Row row;
  if (const toml::array* list = start[key].as_array()) {
    for (const auto& number : *list) row.push_back(number.value_or(0.0));
  }
  return row;
}
bool shows(const toml::table& start, std::string_view what) {
  const toml::array* list = start["show"].as_array();
  return list != nullptr && std::any_of(list->begin(), list->end(), [&](const auto& word) {
           return word.value_or(std::string_view()) == what;
         });
}

/// An empty page for a window of the world, and the map to it.
struct Drawing {
  DisplayList list;
  Panel panel;
};
Drawing drawing_of(const Eigen::AlignedBox2d& world, double width = kWidth) {
  const Vec<2> size = world.sizes();
  const double height = width * size[1] / size[0];
  const Box inside{{kMargin, kMargin}, {width - kMargin, height - kMargin}};
  return {{.width = width, .height = height}, Panel(inside, {world.min(), world.max()})};
}
Eigen::AlignedBox2d box_of(const Row& corners) {
  return {Vec<2>(corners[0], corners[1]), Vec<2>(corners[2], corners[3])};
}

Label text_at(const Vec<2>& at, const std::string& text, Colour colour = style::kInk) {
  return {.text = text,
          .at = at,
          .size = 10,
          .colour = colour,
          .across = Across::centre,
          .along = Along::middle};
}

void add_circle(DisplayList& list, const Vec<2>& centre, double radius, const Stroke& stroke,
                const std::vector<double>& dashes) {
  constexpr int kCorners = 96;
  std::vector<Vec<2>> points;
  for (int k = 0; k <= kCorners; ++k) {
    const double angle = 2 * std::numbers::pi * k / kCorners;
    points.push_back(centre + radius * Vec<2>(std::cos(angle), std::sin(angle)));
  }
  list.add(Polyline{points, stroke, dashes});
}

// ---- Discs --------------------------------------------------------------------------------------

Discs discs_of(const toml::table& start) {
  std::vector<std::array<double, 3>> rows;
  for (const Row& row : rows_of(start, "discs")) {
    if (row.size() != 3) throw SceneError("a disc is a list of x, y and radius");
    rows.push_back({row[0], row[1], row[2]});
  }
  if (rows.empty()) throw SceneError("discs: expected a list of [x, y, radius]");
  return make_discs(rows);
}

Eigen::VectorXd weights_by(int rule, const Eigen::VectorXd& radius) {
  switch (rule) {
    case 1:
      return radius.array().sqrt();
    case 2:
      return radius;
    case 3:
      return Eigen::VectorXd::Zero(radius.size());
    default:
      return radius.array().square();
  }
}

/// As the bench has it when the start names none.
Eigen::AlignedBox2d box_around(const Discs& discs) {
  Eigen::AlignedBox2d box;
  for (int i = 0; i < discs.size(); ++i) {
    const Vec<2> half = Vec<2>::Constant(discs.radius[i]);
    box.extend(discs.at(i) - half).extend(discs.at(i) + half);
  }
  const Vec<2> margin = Vec<2>::Constant(0.12 * box.sizes().maxCoeff());
  return {box.min() - margin, box.max() + margin};
}

/// The contacts that T has no edge for: yellow on black, as on the page.
void add_missed(DisplayList& list, const View& view, const std::vector<Pair>& missed) {
  constexpr Colour kYellow{255, 212, 0, 255};
  add_edges(list, view, missed, {style::kInk, 4.5});
  add_edges(list, view, missed, {kYellow, 2.6});
}

DisplayList picture_of_discs(const toml::table& start) {
  const Discs discs = discs_of(start);
  const double skin = start["skin"].value_or(0.0);
  const int rule = start["rule"].value_or(0);
  const Row box = row_of(start, "box");
  Drawing page = drawing_of(box.size() == 4 ? box_of(box) : box_around(discs));
  DisplayList& list = page.list;
  const Found found = find_contacts(discs, weights_by(rule, (1 + skin) * discs.radius));
  const View view{page.panel, discs};
  list.add(PushClip{page.panel.box()});
  if (shows(start, "cells")) {
    add_cells_and_discs(list, view, found.triangulation);
  } else {
    add_fills(list, view, style::kGrain);
    add_outlines(list, view, style::kGrainLine);
  }
  for (const int i : found.triangulation.hidden()) {
    list.add(Disc{.centre = view.centre(i), .radius = view.radius(i), .fill = style::kPaper});
    add_circle(list, view.centre(i), view.radius(i), style::kGrainLine, kDashes);
  }
  for (int i = 0; skin > 0 && i < discs.size(); ++i) {
    add_circle(list, view.centre(i), (1 + skin) * view.radius(i), {style::kEdgeNew, 0.8}, kDashes);
  }
  if (shows(start, "edges")) add_edges(list, view, found.edges, kEdgeLine);
  add_edges(list, view, found.found, kContactLine);
  add_missed(list, view, found.missed);
  constexpr int kMostNumbers = 60;
  for (int i = 0; discs.size() <= kMostNumbers && i < discs.size(); ++i) {
    list.add(text_at(view.centre(i), std::to_string(i)));
  }
  Row from = row_of(start, "tangent");
  if (from.empty() && shows(start, "tangent")) from = row_of(start, "from");
  if (from.size() == 2) {
    const Vec<2> x(from[0], from[1]);
    const Vec<2> touch = tangent_point(discs.at(0), discs.radius[0], x);
    list.add(Polyline{{view.centre(0), view.point(touch)}, {style::kInk, 0.8}, kDashes});
    list.add(Segment{view.point(touch), view.point(x), kContactLine});
    list.add(Disc{.centre = view.point(x), .radius = 3, .fill = style::kContact});
  }
  list.add(PopClip{});
  return std::move(page.list);
}

/// Discs at random places that hardly overlap, in a frame 1 wide and 0.7 high.
toml::array random_discs(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::array<double, 3>> discs;
  constexpr int kMostTries = 100000;
  // Few discs are large.
  const double most = std::min(0.12, 0.5 / std::sqrt(count)), least = 0.35 * most;
  for (int tries = 0; static_cast<int>(discs.size()) < count && tries < kMostTries; ++tries) {
    const double r = random.uniform(least, most);
    const double x = random.uniform(r, 1 - r), y = random.uniform(r, 0.7 - r);
    const bool free = std::all_of(discs.begin(), discs.end(), [&](const auto& disc) {
      return std::hypot(disc[0] - x, disc[1] - y) > 0.93 * (disc[2] + r);
    });
    if (free) discs.push_back({x, y, r});
  }
  toml::array list;
  for (const auto& disc : discs) {
    // Four digits do for a start, and keep the page short.
    toml::array row;
    for (const double value : disc) row.push_back(std::round(value * 1e4) / 1e4);
    list.push_back(std::move(row));
  }
  return list;
}

// ---- Other benches ------------------------------------------------------------------------------

/// A start that begins in the air is shown a moment later, when there is something to see.
DisplayList picture_of_grains(const toml::table& start) {
  const std::map<std::string, int> kinds{{"pour", 0}, {"bed", 1}, {"bounce", 2}, {"cloud", 3}};
  const std::string kind = start["kind"].value_or(std::string("pour"));
  const auto known = kinds.find(kind);
  if (known == kinds.end()) throw SceneError("there is no kind of grains " + shown(kind));
  grains_leap(start["leap"].value_or(true) ? 1 : 0);
  if (grains_start(known->second, start["count"].value_or(200), start["seed"].value_or(1),
                   start["friction"].value_or(0.4), start["restitution"].value_or(0.5)) == 0) {
    throw SceneError(lagrain_error());
  }
  constexpr double kLater = 1.2;  // [s]
  if (kind == "pour") {
    while (grains_time() < kLater && grains_step(500) != 0) {
    }
  }
  const Row box = row_of(start, "box");
  Drawing page =
      drawing_of(box.size() == 4 ? box_of(box) : box_of({-0.05, -0.05, 1.05, 1.05}), 0.75 * kWidth);
  DisplayList& list = page.list;
  list.add(PushClip{page.panel.box()});
  const bool forces = shows(start, "forces");
  const int count = grains_places();
  for (int i = 0; i < count; ++i) {
    const double* g = lagrain_reals() + 4 * i;
    list.add(Disc{page.panel.point({g[0], g[1]}),
                  page.panel.length(g[2]),
                  forces ? style::kGrainPale : style::kGrain,
                  {style::kGrainOutline, style::kThin}});
  }
  if (shows(start, "skins")) {
    const int edges = grains_triangulation();
    const double* reals = lagrain_reals();
    const auto place = [&](int i) -> Vec<2> {
      return page.panel.point({reals[4 * i], reals[4 * i + 1]});
    };
    for (int k = 0; k < edges; ++k) {
      const int* edge = lagrain_ints() + 2 * k;
      list.add(Segment{place(edge[0]), place(edge[1]), {style::kEdge, style::kHairline}});
    }
    for (int i = 0; i < count; ++i) {
      const double reach = reals[4 * i + 2] + reals[4 * i + 3];
      add_circle(list, place(i), page.panel.length(reach), {style::kEdgeNew, style::kThin}, {2, 2});
    }
  }
  if (forces) {
    const int contacts = grains_contacts();
    double sum = 0;
    for (int k = 0; k < contacts; ++k) sum += lagrain_reals()[5 * k + 4];
    for (int k = 0; k < contacts; ++k) {
      const double* c = lagrain_reals() + 5 * k;
      const double width = std::min(6.0, 1.1 * c[4] * contacts / sum);
      if (width < 0.15) continue;
      list.add(Segment{page.panel.point({c[0], c[1]}),
                       page.panel.point({c[2], c[3]}),
                       {style::kContact, width}});
    }
  }
  const int walls = grains_walls();
  for (int k = 0; k < walls; ++k) {
    const double* w = lagrain_reals() + 4 * k;
    list.add(
        Segment{page.panel.point({w[0], w[1]}), page.panel.point({w[2], w[3]}), {style::kWall, 2}});
  }
  list.add(PopClip{});
  return std::move(page.list);
}

DisplayList picture_of_signs(const toml::table& start) {
  constexpr int kSide = 128;
  constexpr double kPixels = 200, kGap = 14;  // [pt]
  const auto point = [&](const char* key, const Row& otherwise) {
    const Row row = row_of(start, key);
    return row.size() == 2 ? row : otherwise;
  };
  const Row p = point("p", {0.5, 0.5}), q = point("q", {12, 12}), r = point("r", {24, 24});
  if (sign_map(kSide, p[0], p[1], q[0], q[1], r[0], r[1]) < 0) throw SceneError(lagrain_error());
  constexpr std::array kColours{style::kEdgeGone, style::kPaper, style::kEdgeNew};
  DisplayList list{.width = 2 * kPixels + kGap, .height = kPixels + 16};
  for (int map = 0; map < 2; ++map) {
    Image image{kSide, kSide, {}};
    for (int row = kSide - 1; row >= 0; --row) {
      for (int column = 0; column < kSide; ++column) {
        const int sign = lagrain_ints()[(map * kSide + row) * kSide + column];
        const Colour c = kColours[static_cast<std::size_t>(sign)];
        image.rgba.insert(image.rgba.end(), {c.r, c.g, c.b, c.a});
      }
    }
    const Box box{{map * (kPixels + kGap), 0}, {map * (kPixels + kGap) + kPixels, kPixels}};
    list.add(Picture{std::move(image), box});
    add_frame(list, box);
    list.add(text_at({box.centre()[0], kPixels + 9}, map == 0 ? "by doubles" : "exact"));
  }
  return list;
}

DisplayList picture_of_work(const toml::table& start) {
  const double restitution = start["restitution"].value_or(0.5);
  Plot plot;
  plot.x = {.label = "evaluations of the force in one contact", .log = true};
  plot.y = {.label = "relative error of the duration", .log = true};
  for (int integrator = 0; integrator < impact_integrators(); ++integrator) {
    Series series = series_style(integrator);
    series.name = impact_integrator_name(integrator);
    for (double steps = 10; steps < 1500; steps *= std::numbers::sqrt2) {
      if (impact(integrator, std::round(steps), restitution) == 0) break;
      series.x.push_back(lagrain_reals()[2]);
      series.y.push_back(lagrain_reals()[1]);
    }
    // Some integrators are for conservative scenes alone.
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  DisplayList list{.width = 330, .height = 230};
  add_plot(list, {{4, 4}, {326, 226}}, plot);
  return list;
}

DisplayList picture_of_lifting(const toml::table& start) {
  const auto sites = rows_of(start, "sites");
  const Row box = row_of(start, "box");
  Drawing page = drawing_of(box.size() == 4 ? box_of(box) : box_of({-2.6, -2.4, 2.6, 5.2}), 300);
  DisplayList& list = page.list;
  const auto at = [&](double x, double y) { return page.panel.point({x, y}); };
  const Vec<2> low = page.panel.box().low;
  list.add(PushClip{page.panel.box()});
  list.add(
      Segment{{low[0], at(0, 0)[1]}, {page.panel.box().high[0], at(0, 0)[1]}, {style::kInk, 0.8}});
  std::vector<Vec<2>> parabola;
  for (int k = -60; k <= 60; ++k) parabola.push_back(at(k / 20.0, k * k / 400.0));
  list.add(Polyline{parabola, {style::kCellOutline, 1}});
  // On a line T is the chain of the sites that are seen.
  std::vector<std::array<double, 3>> rows;
  for (const Row& site : sites) rows.push_back({site.at(0), 0, site.at(1)});
  const Discs discs = make_discs(rows);
  const Found found = find_contacts(discs);
  const auto lifted = [&](int i) {
    const double x = discs.at(i)[0], r = discs.radius[i];
    return at(x, x * x - r * r);
  };
  for (const Pair& edge : found.edges) {
    list.add(Segment{lifted(edge.i), lifted(edge.j), {style::kEdgeNew, 2.2}});
    const double a = discs.at(edge.i)[0], b = discs.at(edge.j)[0];
    const double rise = b * b - a * a - discs.radius[edge.j] * discs.radius[edge.j] +
                        discs.radius[edge.i] * discs.radius[edge.i];
    const double border = rise / (b - a) / 2;
    list.add(Segment{at(border, -0.4), at(border, 0.4), kContactLine});
  }
  const auto hidden = found.triangulation.hidden();
  for (int i = 0; i < discs.size(); ++i) {
    const double x = discs.at(i)[0], r = discs.radius[i];
    list.add(Polyline{{at(x, 0), lifted(i)}, {style::kFaint, 0.8}, kDashes});
    list.add(Segment{at(x - r, 0), at(x + r, 0), {with_alpha(style::kGrainOutline, 0.5), 3}});
    const bool above = std::find(hidden.begin(), hidden.end(), i) != hidden.end();
    list.add(Disc{lifted(i), 4, above ? style::kPaper : style::kEdgeNew, {style::kInk, 0.8}});
    list.add(text_at(at(x, 0) + Vec<2>(0, -12), std::to_string(i)));
  }
  list.add(PopClip{});
  return std::move(page.list);
}

DisplayList picture_of_flips(const toml::table& start) {
  const auto sites = rows_of(start, "sites");
  const auto triangles = rows_of(start, "triangles");
  std::vector<std::array<double, 3>> rows;
  for (const Row& site : sites) rows.push_back({site.at(0), site.at(1), site.at(2)});
  const Discs discs = make_discs(rows);
  const Found found = find_contacts(discs);
  Drawing page = drawing_of(box_around(discs));
  const View view{page.panel, discs};
  std::vector<Pair> edges;
  for (const Row& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = static_cast<int>(t.at(k)), b = static_cast<int>(t.at((k + 1) % 3));
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  add_edges(page.list, view, edges, kEdgeLine);
  // Not all of these are bad edges, but all of them have to go.
  for (const Pair& edge : without(edges, found.edges)) {
    page.list.add(
        Polyline{{view.centre(edge.i), view.centre(edge.j)}, {style::kEdgeGone, 1.8}, kDashes});
  }
  for (int i = 0; i < discs.size(); ++i) {
    page.list.add(Disc{view.centre(i), 8, style::kGrain, style::kGrainLine});
    page.list.add(text_at(view.centre(i), std::to_string(i)));
  }
  return std::move(page.list);
}

/// Tetrahedra before a flip and after it, drawn a little apart, from the same side.
DisplayList picture_of_space(const toml::table& start) {
  constexpr double kSide = 200, kScale = 62;  // [pt]
  const toml::array* flips = start["flips"].as_array();
  const toml::table* flip = flips != nullptr && !flips->empty() ? (*flips)[0].as_table() : nullptr;
  if (flip == nullptr) throw SceneError("flips: expected a list of tables");
  const auto points = rows_of(*flip, "points");
  DisplayList list{.width = 2 * kSide, .height = kSide};
  Vec<3> centre = Vec<3>::Zero();
  for (const Row& p : points) centre += Vec<3>(p.at(0), p.at(1), p.at(2)) / points.size();
  constexpr double kTurn = 0.5, kTip = 0.35;  // [rad]
  const auto seen = [&](const Vec<3>& x) {
    const double u = x[0] * std::cos(kTurn) - x[1] * std::sin(kTurn);
    const double v = x[0] * std::sin(kTurn) + x[1] * std::cos(kTurn);
    return Vec<3>(u, x[2] * std::cos(kTip) - v * std::sin(kTip),
                  v * std::cos(kTip) + x[2] * std::sin(kTip));
  };
  int column = 0;
  for (const char* when : {"before", "after"}) {
    const Vec<2> middle((column++ + 0.5) * kSide, 0.5 * kSide);
    struct Face {
      std::vector<Vec<2>> corners;
      double depth;
      Colour fill;
    };
    std::vector<Face> faces;
    constexpr std::array kFills{style::kGrain, style::kCell, style::kGrainPale, style::kFaint};
    int number = 0;
    for (const Row& tetrahedron : rows_of(*flip, when)) {
      std::vector<Vec<3>> corners;
      Vec<3> own = Vec<3>::Zero();
      for (const double i : tetrahedron) {
        const Row& p = points.at(static_cast<std::size_t>(i));
        corners.emplace_back(Vec<3>(p[0], p[1], p[2]) - centre);
        own += corners.back() / 4;
      }
      for (std::size_t left = 0; left < 4; ++left) {
        Face face{{}, 0, with_alpha(kFills[static_cast<std::size_t>(number) % kFills.size()], 0.6)};
        for (std::size_t k = 0; k < 4; ++k) {
          if (k == left) continue;
          const Vec<3> at = seen(corners[k] + 0.35 * own);
          face.corners.push_back(middle + kScale * Vec<2>(at[0], at[1]));
          face.depth += at[2];
        }
        faces.push_back(std::move(face));
      }
      ++number;
    }
    std::sort(faces.begin(), faces.end(),
              [](const Face& a, const Face& b) { return a.depth > b.depth; });
    for (const Face& face : faces) {
      list.add(Polygon{face.corners, face.fill, {style::kGrainOutline, style::kMedium}});
    }
  }
  return list;
}

// ---- Pictures by name ---------------------------------------------------------------------------

/// Discs before a move, and after it with the edges of before: what they no longer find.
DisplayList picture_of_stale() {
  const Figure4 figure = make_figure4();
  constexpr double kSide = 210, kGap = 16;  // [pt]
  DisplayList list{.width = 2 * kSide + kGap, .height = kSide + 16};
  const auto add = [&](double left, const Discs& discs, const std::string& title) {
    const Panel panel({{left, 0}, {left + kSide, kSide}}, {{0, 0}, {figure.side, figure.side}});
    const View view{panel, discs};
    add_fills(list, view, style::kGrain);
    add_outlines(list, view, style::kGrainLine);
    add_edges(list, view, figure.stale, kEdgeLine);
    std::vector<Pair> found, missed;
    for (const Pair& contact : contacts_of(discs)) {
      (holds(figure.stale, contact) ? found : missed).push_back(contact);
    }
    add_edges(list, view, found, kContactLine);
    add_missed(list, view, missed);
    add_frame(list, panel.box());
    list.add(text_at({panel.box().centre()[0], kSide + 9}, title));
  };
  add(0, figure.before, "before the move");
  add(kSide + kGap, figure.after.discs, "after it, with the old edges");
  return list;
}

/// The height of a disc that bounces, and the closed form, a parabola for each flight.
DisplayList picture_of_bounce() {
  constexpr double kRestitution = 0.5, kHeight = 1, kGravity = 9.81, kEnd = 1.6;
  if (grains_start(2, 1, 1, 0.3, kRestitution) == 0) throw SceneError(lagrain_error());
  Series simulated = series_style(0), exact = series_style(1);
  simulated.name = "simulated";
  exact.name = "closed form";
  const int steps = std::max(1, static_cast<int>(kEnd / 300 / grains_time_step()));
  while (grains_time() < kEnd) {
    grains_places();
    simulated.x.push_back(grains_time());
    simulated.y.push_back(lagrain_reals()[1] - lagrain_reals()[2]);
    if (grains_step(steps) == 0) throw SceneError(lagrain_error());
  }
  const double fall = std::sqrt(2 * kHeight / kGravity);
  for (const double t : simulated.x) {
    double begin = fall, speed = kRestitution * kGravity * fall, height = 0;
    if (t < fall) {
      height = kHeight - 0.5 * kGravity * t * t;
    } else {
      while (speed > 1e-3 && t > begin + 2 * speed / kGravity) {
        begin += 2 * speed / kGravity;
        speed *= kRestitution;
      }
      height = std::max(0.0, speed * (t - begin) - 0.5 * kGravity * (t - begin) * (t - begin));
    }
    exact.x.push_back(t);
    exact.y.push_back(height);
  }
  Plot plot;
  plot.x = {.label = "time [s]"};
  plot.y = {.label = "height above the floor [m]"};
  plot.series = {simulated, exact};
  DisplayList list{.width = 330, .height = 200};
  add_plot(list, {{4, 4}, {326, 196}}, plot);
  return list;
}

toml::table table_of(const char* text) { return toml::parse(std::string_view(text)); }

const std::map<std::string, std::function<DisplayList()>>& all_pictures() {
  static const std::map<std::string, std::function<DisplayList()>> pictures{
      {"stale", picture_of_stale},
      {"bounce", picture_of_bounce},
      {"work", [] { return picture_of_work({}); }},
      {"signs", [] { return picture_of_signs({}); }},
      {"lifting",
       [] {
         return picture_of_lifting(
             table_of("sites = [[-2, 0.5], [-0.8, 0.4], [0.5, 0.7], [1.7, 0.5]]"));
       }},
      {"flip_2_3",
       [] {
         return picture_of_space(table_of(
             "flips = [{ points = [[1, 0, 0], [-0.5, 0.87, 0], [-0.5, -0.87, 0], [0, 0, -1], "
             "[0, 0, 1]], before = [[0, 1, 2, 3], [0, 1, 2, 4]], after = [[3, 4, 0, 1], "
             "[3, 4, 1, 2], [3, 4, 2, 0]] }]"));
       }},
  };
  return pictures;
}

}  // namespace

DisplayList lesson_picture(const std::string& name) {
  const auto found = all_pictures().find(name);
  if (found != all_pictures().end()) return found->second();
  throw SceneError("there is no picture " + shown(name) + suggestion(name, lesson_pictures()));
}

std::vector<std::string> lesson_pictures() {
  std::vector<std::string> names;
  for (const auto& [name, draw] : all_pictures()) names.push_back(name);
  return names;
}

DisplayList picture_of_bench(const std::string& bench, const toml::table& start) {
  if (bench == "discs") return picture_of_discs(start);
  if (bench == "grains") return picture_of_grains(start);
  if (bench == "signs") return picture_of_signs(start);
  if (bench == "work") return picture_of_work(start);
  if (bench == "lifting") return picture_of_lifting(start);
  if (bench == "flips") return picture_of_flips(start);
  if (bench == "space") return picture_of_space(start);
  throw SceneError(
      "there is no bench " + shown(bench) +
      suggestion(bench, {"discs", "grains", "signs", "work", "lifting", "flips", "space"}));
}

void complete_start(const std::string& bench, toml::table& start) {
  if (bench == "discs" && start.contains("random")) {
    const auto seed = static_cast<std::uint64_t>(start["seed"].value_or(1));
    start.insert("discs", random_discs(start["random"].value_or(24), seed));
    start.erase("random");
    start.erase("seed");
    start.insert("box", toml::array{0.0, 0.0, 1.0, 0.7});
  }
  if (bench == "flips" && !start.contains("triangles")) {
    const FlipStart flips = disordered_triangulation(rows_of(start, "sites"));
    toml::array triangles;
    for (const auto& t : flips.triangles) triangles.push_back(toml::array{t[0], t[1], t[2]});
    start.insert("triangles", std::move(triangles));
    start.insert("least", least_flips(flips));
  }
  if (bench == "work") {
    toml::array names;
    for (int k = 0; k < impact_integrators(); ++k) names.push_back(impact_integrator_name(k));
    start.insert("integrators", std::move(names));
  }
}

}  // namespace lagrain::figures
