// SPDX-License-Identifier: GPL-3.0-or-later
// The figures' pictures are read as numbers: what they claim is checked against brute force and
// against closed forms.

#include "geometry_drawing.hpp"
#include "geometry_figures.hpp"

#include <lagrain/text.hpp>

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <variant>

using namespace lagrain;
using namespace lagrain::figures;

namespace {

/// All pairs at a distance of at most the sum of their radii, written independently.
std::vector<Pair> touching(const Discs& discs) {
  std::vector<Pair> pairs;
  for (int i = 0; i < discs.size(); ++i) {
    for (int j = i + 1; j < discs.size(); ++j) {
      const double dx = discs.centre(0, i) - discs.centre(0, j);
      const double dy = discs.centre(1, i) - discs.centre(1, j);
      if (std::hypot(dx, dy) <= discs.radius[i] + discs.radius[j]) pairs.push_back({i, j});
    }
  }
  return pairs;
}

/// Straight lines of a colour and width between two points of the page.
int lines_between(const DisplayList& list, const Stroke& stroke, const Vec<2>& a, const Vec<2>& b) {
  return static_cast<int>(
      std::count_if(list.items.begin(), list.items.end(), [&](const Item& item) {
        const auto* line = std::get_if<Segment>(&item);
        return line != nullptr && line->stroke.colour == stroke.colour &&
               line->stroke.width == stroke.width && (line->a - a).norm() < 1e-9 &&
               (line->b - b).norm() < 1e-9;
      }));
}

/// Labels are large enough, lie on the page, and none covers another.
void check_labels(const DisplayList& list) {
  std::vector<Box> boxes;
  for (const Item& item : list.items) {
    const auto* label = std::get_if<Label>(&item);
    if (label == nullptr || label->text.empty()) continue;
    CAPTURE(label->text);
    CHECK(label->size >= 7);
    const Box box = label_box(*label);
    CHECK(list.page().contains(box.low));
    CHECK(list.page().contains(box.high));
    for (const Box& other : boxes) {
      CHECK((box.high[0] < other.low[0] || other.high[0] < box.low[0] ||
             box.high[1] < other.low[1] || other.high[1] < box.low[1]));
    }
    boxes.push_back(box);
  }
  CHECK(!boxes.empty());
}

/// Found once: the search goes through many seeds.
const Figure4& figure4() {
  static const Figure4 figure = make_figure4();
  return figure;
}

}  // namespace

TEST_SUITE("figure 1") {
  TEST_CASE("24 discs at rest, every contact is marked, and Euler's relation holds") {
    const Figure1 figure = make_figure1();
    const Discs& discs = figure.scene.discs;
    const DisplayList list = picture_of(figure);
    const Panel panel = figure1_panel(figure);

    CHECK(discs.size() == 24);
    CHECK(figure.contacts.edges.size() == static_cast<std::size_t>(3 * 24 - 3 - figure.hull));
    CHECK(figure.contacts.missed.empty());
    CHECK(figure.contacts.found == touching(discs));
    CHECK(figure.contacts.found.size() >= 24);
    for (const Pair& edge : figure.contacts.edges) {
      const bool contact = holds(figure.contacts.found, edge);
      const Vec<2> a = panel.point(discs.at(edge.i)), b = panel.point(discs.at(edge.j));
      CHECK(lines_between(list, kContactLine, a, b) == (contact ? 1 : 0));
      CHECK(lines_between(list, kEdgeLine, a, b) == (contact ? 0 : 1));
    }
    CHECK(test::relative_error(list.width, style::kColumn) < 1e-15);
    check_labels(list);
  }

  TEST_CASE("the discs are at rest and the run missed nothing") {
    const Settled scene = make_figure1().scene;

    CHECK(scene.kinetic_energy < 1e-12);
    CHECK(scene.largest_overlap < 0.02);
    CHECK(scene.audited > 0);
    CHECK(scene.missed == 0);
    for (int i = 0; i < scene.discs.size(); ++i) {
      // Nobody has left the box; walls give way by an overlap.
      const double r = 0.98 * scene.discs.radius[i];
      CHECK(scene.discs.at(i)[0] > r);
      CHECK(scene.discs.at(i)[0] < scene.width - r);
      CHECK(scene.discs.at(i)[1] > r);
    }
  }
}

TEST_SUITE("figure 2") {
  TEST_CASE("the power is the square of the tangent's length, at a right angle") {
    const Figure2 figure = make_figure2();
    const Discs& discs = figure.cells.discs;
    const Vec<2> tangent = figure.x - figure.tangent_point;
    const Vec<2> radius = figure.tangent_point - discs.at(0);

    CHECK(test::relative_error(tangent.squaredNorm(), discs.power(0, figure.x)) < 1e-12);
    CHECK(test::relative_error(radius.norm(), discs.radius[0]) < 1e-12);
    CHECK(std::abs(tangent.dot(radius)) < 1e-12);
    for (int i = 1; i < 4; ++i) CHECK(discs.power(0, figure.x) < discs.power(i, figure.x));
    CHECK(touching(discs).empty());
    CHECK(figure.cells.edges.size() == 5);
  }

  TEST_CASE("weight r^2 has the edge that carries the contact, weight sqrt(r) the other one") {
    const Figure2 figure = make_figure2();

    CHECK(touching(figure.squares.discs) == std::vector<Pair>{{0, 1}});
    // The overlap is a difference of lengths of about 20, which round to 4e-15.
    CHECK(test::relative_error(figure.squares.discs.overlap({0, 1}), 0.02) < 1e-12);
    CHECK(holds(figure.squares.edges, {0, 1}));
    CHECK(!holds(figure.squares.edges, {2, 3}));
    CHECK(figure.squares.missed.empty());
    CHECK(!holds(figure.roots.edges, {0, 1}));
    CHECK(holds(figure.roots.edges, {2, 3}));
    CHECK(figure.roots.missed == std::vector<Pair>{{0, 1}});
    check_labels(picture_of(figure));
  }
}

TEST_SUITE("figure 3") {
  TEST_CASE("overlaps of any depth below 2 - sqrt 2 of the smaller radius are all found") {
    const Figure3 figure = make_figure3();
    const Found& found = figure.overlapping;

    CHECK(found.found == touching(found.discs));
    CHECK(found.missed.empty());
    CHECK(found.found.size() > 10);
    double deepest = 0;
    for (const Pair& pair : found.found) {
      const double share = found.discs.overlap(pair) /
                           std::min(found.discs.radius[pair.i], found.discs.radius[pair.j]);
      CHECK(share < 2 - std::sqrt(2.0));
      deepest = std::max(deepest, share);
    }
    CHECK(deepest > 0.4);
    check_labels(picture_of(figure));
  }

  TEST_CASE("in a square of four, the contact is found below the threshold and missed above") {
    const Figure3 figure = make_figure3();
    const double threshold = 2 - std::sqrt(2.0);

    CHECK(figure.below.discs.overlap({0, 2}) < threshold);
    CHECK(figure.below.discs.overlap({0, 2}) > threshold - 1e-3);
    CHECK(figure.below.discs.overlap({0, 1}) > 0);
    CHECK(holds(figure.below.found, {0, 1}));
    CHECK(figure.below.missed.empty());
    CHECK(figure.above.discs.overlap({0, 2}) > threshold);
    CHECK(figure.above.discs.overlap({0, 2}) < threshold + 1e-3);
    CHECK(figure.above.discs.overlap({0, 1}) > 0);
    CHECK(figure.above.missed == std::vector<Pair>{{0, 1}});
  }
}

TEST_SUITE("figure 4") {
  TEST_CASE("the move exchanges exactly the marked edges, and the new one carries the contact") {
    const Figure4& figure = figure4();
    const std::vector<Pair> contacts = touching(figure.after.discs);

    CHECK(without(figure.stale, figure.after.edges) == std::vector<Pair>{figure.gone});
    CHECK(without(figure.after.edges, figure.stale) == std::vector<Pair>{figure.fresh});
    CHECK(without(contacts, figure.stale) == std::vector<Pair>{figure.fresh});
    CHECK(without(contacts, figure.after.edges).empty());
    CHECK(figure.after.found == contacts);
    CHECK(contacts.size() >= 2);
    CHECK(figure.update.flips >= 1);
    CHECK(figure.update.rebuilds == 0);
    const DisplayList list = picture_of(figure);
    const auto count = [&](const Stroke& stroke, auto outline_of) {
      return std::count_if(list.items.begin(), list.items.end(), [&](const Item& item) {
        const Stroke* drawn = outline_of(item);
        return drawn != nullptr && drawn->colour == stroke.colour && drawn->width == stroke.width;
      });
    };
    // One ring and one new edge in the panels, and one sample of each in the legend.
    CHECK(count(kMissedLine, [](const Item& item) {
            const auto* disc = std::get_if<Disc>(&item);
            return disc != nullptr ? &disc->outline : nullptr;
          }) == 2);
    CHECK(count(kNewLine, [](const Item& item) {
            const auto* line = std::get_if<Segment>(&item);
            return line != nullptr ? &line->stroke : nullptr;
          }) == 2);
    check_labels(list);
  }

  TEST_CASE("the moved triangulation is the one built anew") {
    const Figure4& figure = figure4();

    CHECK(figure.after.triangulation.audit().empty());
    CHECK(edges_of(figure.after.triangulation) == find_contacts(figure.after.discs).edges);
  }

  TEST_CASE("in the video T misses no collision, and T of time 0 does") {
    const Flight flight = fly(16, figure4().seed, 0.5, kLeastInterval);
    const std::vector<FilmFrame> frames = film(flight, 16);

    CHECK(flight.energy_drift < 0.01);
    CHECK(flight.largest_overlap < 0.04);
    CHECK(frames.back().contacts > 5);
    CHECK(frames.back().missed == 0);
    CHECK(frames.back().missed_by_first > 0);
    CHECK(frames.back().flips > 0);
    for (const FilmFrame& frame : frames) {
      CHECK(frame.edges == find_contacts(frame.discs).edges);
    }
    check_labels(picture_of(frames.back(), flight.side));
  }
}
