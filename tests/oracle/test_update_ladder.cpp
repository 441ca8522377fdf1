// SPDX-License-Identifier: GPL-3.0-or-later
/// Every rung of the ladder of updates, in the plane and in space: long random scripts on small
/// sets, with exact ties and without. After each update T is compared with a build from nothing and
/// with CGAL, and its edges with its neighbours.

#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>

#include "dim2/sets2.hpp"
#include "dim3/sets3.hpp"
#include "oracle/cgal2.hpp"
#include "oracle/cgal3.hpp"
#include "support/cases.hpp"
#include "support/space.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

using namespace lagrain;
using test::Edge;
using test::Space;

namespace {

std::vector<test::Triple> simplices(const Triangulation<2>& t) {
  auto list = test::triangles(t);
  for (auto& triple : list) std::sort(triple.begin(), triple.end());
  std::sort(list.begin(), list.end());
  return list;
}

std::vector<test::Four> simplices(const Triangulation<3>& t) { return test::tetrahedra(t); }

template <int Dim>
std::vector<int> present(const Triangulation<Dim>& t) {
  std::vector<int> ids;
  for (int i = 0; i < t.size(); ++i) {
    if (t.contains(i)) ids.push_back(i);
  }
  return ids;
}

template <int Dim>
bool tiny_or_flat(const Triangulation<Dim>& t) {
  return t.dimension() < Dim ||
         static_cast<int>(test::visible(t).size()) < Triangulation<Dim>::kTiny;
}

template <int Dim>
std::vector<test::SiteSet<Dim>> all_kinds(Random& random) {
  if constexpr (Dim == 2) {
    auto kinds = test::all_kinds(random);
    kinds.push_back(test::collinear(random, 12));
    return kinds;
  } else {
    return test3::all_kinds(random, 3);
  }
}

// ---- Scripts -----------------------------------------------------------------------------------

/// A set of sites and the updates that become of it, all from one seed.
template <int Dim>
class Script {
 public:
  explicit Script(int seed) : random_(static_cast<std::uint64_t>(seed)) {
    constexpr std::array kKinds{Places::lattice, Places::general, Places::lattice, Places::mixed};
    kind_ = kKinds[static_cast<std::size_t>(seed) % kKinds.size()];
    const int count = Dim == 2 ? 12 + random_.below(39) : 20 + random_.below(31);
    range_ = Dim == 2 ? 4 + random_.below(5) : 3 + random_.below(3);
    sites_.x.resize(Dim, count);
    sites_.w.resize(count);
    for (int i = 0; i < count; ++i) {
      sites_.x.col(i) = place(i);
      sites_.w[i] = weight(i);
    }
    t_ = test::built(sites_);
  }

  const test::SiteSet<Dim>& sites() const { return sites_; }
  Triangulation<Dim>& triangulation() { return t_; }

  UpdateReport update() {
    const auto ids = present(t_);
    const double what = random_.uniform();
    if (what < 0.05) return insert_or_remove();
    std::vector<int> moved;
    if (what < 0.35) {
      moved = some(ids);
      for (const int i : moved) sites_.x.col(i) += step(i);
    } else if (what < 0.4) {
      moved = some(ids);
      for (const int i : moved) sites_.x.col(i) = place(i);
    } else if (what < 0.6) {
      moved = few(ids);
      // Powers of two lead from lattice to lattice.
      const int far = 8 << random_.below(4);
      for (const int i : moved) sites_.x.col(i) += far * step(i);
    } else if (what < 0.7) {
      moved = outside(ids);
      for (const int i : moved) sites_.x.col(i) = place(i);
    } else if (what < 0.85) {
      moved = some(ids);
      for (const int i : moved) sites_.w[i] = weight(i);
    } else {
      moved = ids;
      swell_or_level(ids);
    }
    return t_.move(moved, sites_.x, sites_.w);
  }

 private:
  enum class Places { lattice, general, mixed };

  bool on_lattice(int i) const {
    return kind_ == Places::lattice || (kind_ == Places::mixed && i % 2 == 0);
  }

  /// In [0, end], whole for a site on the lattice.
  double number(int i, int end) {
    return on_lattice(i) ? random_.below(end + 1) : random_.uniform(0, end);
  }

  Vec<Dim> place(int i) {
    Vec<Dim> x;
    for (int axis = 0; axis < Dim; ++axis) x[axis] = 0.5 * number(i, 2 * range_);
    return x;
  }

  Vec<Dim> step(int i) {
    Vec<Dim> x;
    for (int axis = 0; axis < Dim; ++axis) x[axis] = 0.5 * (number(i, 2) - 1);
    return x;
  }

  double weight(int i) { return number(i, random_.uniform() < 0.03 ? 50 : 2); }

  int any(const std::vector<int>& ids) {
    return ids[static_cast<std::size_t>(random_.below(static_cast<int>(ids.size())))];
  }

  std::vector<int> few(const std::vector<int>& ids) {
    std::vector<int> list;
    for (int k = 1 + random_.below(4); k > 0; --k) list.push_back(any(ids));
    return list;
  }

  std::vector<int> some(const std::vector<int>& ids) {
    return random_.uniform() < 0.3 ? ids : few(ids);
  }

  /// Of the region where sites are placed at random.
  std::vector<int> outside(const std::vector<int>& ids) const {
    std::vector<int> list;
    std::copy_if(ids.begin(), ids.end(), std::back_inserter(list), [&](int i) {
      return sites_.x.col(i).minCoeff() < 0 || sites_.x.col(i).maxCoeff() > range_;
    });
    return list;
  }

  /// All weights become equal if a site is heavy, else many become heavy. In the plane flips get
  /// stuck where several sites around a small face are hidden at once, and seldom elsewhere.
  void swell_or_level(const std::vector<int>& ids) {
    const bool heavy = std::any_of(ids.begin(), ids.end(), [&](int i) { return sites_.w[i] > 2; });
    for (const int i : ids) {
      if (heavy) sites_.w[i] = 1;
      if (!heavy && random_.uniform() < 0.4) sites_.w[i] = number(i, 50);
    }
  }

  /// A third at most is absent.
  UpdateReport insert_or_remove() {
    const int i = random_.below(sites_.size());
    if (t_.contains(i)) {
      const auto count = static_cast<int>(present(t_).size());
      return 3 * count > 2 * sites_.size() ? t_.remove(i) : UpdateReport{};
    }
    sites_.x.col(i) = place(i);
    sites_.w[i] = weight(i);
    return t_.insert(i, sites_.x.col(i), sites_.w[i]);
  }

  Random random_;
  Places kind_ = Places::lattice;
  int range_ = 0;
  test::SiteSet<Dim> sites_;
  Triangulation<Dim> t_;
};

// ---- Checks ------------------------------------------------------------------------------------

std::string named(const Edge& edge) {
  return std::to_string(edge.first) + "-" + std::to_string(edge.second);
}

/// Each edge as often as one of its ends names the other; sorted.
template <int Dim>
std::vector<Edge> ends(const Triangulation<Dim>& t) {
  std::vector<Edge> list;
  for (int i = 0; i < t.size(); ++i) {
    t.for_each_neighbour(i, [&](int j) { list.push_back(test::sorted(i, j)); });
  }
  std::sort(list.begin(), list.end());
  return list;
}

/// Where the list of edges and the neighbours differ, in words.
template <int Dim>
std::string edge_faults(const Triangulation<Dim>& t) {
  std::string faults;
  std::map<Edge, std::pair<int, int>> counts;
  for (const Edge& edge : ends(t)) ++counts[edge].second;
  std::vector<Edge> list;
  t.for_each_edge([&](int i, int j) { list.emplace_back(i, j); });
  for (const Edge& edge : list) ++counts[edge].first;
  for (const auto& [edge, count] : counts) {
    if (count == std::pair(1, 2)) continue;
    faults += named(edge) + " is listed " + std::to_string(count.first) + " times and has " +
              std::to_string(count.second) + " ends; ";
  }
  if (!std::is_sorted(list.begin(), list.end())) faults += "the list is not sorted; ";
  return faults;
}

/// Edges that were not there before and that T does not tell of, in words.
/// @pre nobody has asked T for its edges since the update
template <int Dim>
std::string untold(const Triangulation<Dim>& t, const std::vector<Edge>& ends_before) {
  std::vector<Edge> told;
  t.for_each_new_edge([&](int i, int j) { told.emplace_back(i, j); });
  std::sort(told.begin(), told.end());
  std::string list;
  for (const Edge& edge : ends(t)) {
    if (std::binary_search(ends_before.begin(), ends_before.end(), edge)) continue;
    if (!std::binary_search(told.begin(), told.end(), edge)) list += named(edge) + "; ";
  }
  return list;
}

/// From nothing, of the present sites only. Absent ids have no place in a build: they join as
/// hidden sites, below a present one, whose removal changes nothing else.
template <int Dim>
Triangulation<Dim> built_of(test::SiteSet<Dim> s, const std::vector<int>& ids) {
  std::vector<int> absent;
  const auto all = test::all_ids(s.size());
  std::set_difference(all.begin(), all.end(), ids.begin(), ids.end(), std::back_inserter(absent));
  for (const int i : absent) {
    s.x.col(i) = s.x.col(ids[0]);
    s.w[i] = s.w[ids[0]] - 1;
  }
  auto t = test::built(s);
  for (const int i : absent) t.remove(i);
  return t;
}

/// CGAL breaks ties by coordinates and we by ids: what is not tied is the same.
template <int Dim>
void check_against_cgal(const Triangulation<Dim>& t, const test::SiteSet<Dim>& s,
                        const std::vector<int>& ids) {
  const auto sides = test::power_sides(t, s, ids);
  REQUIRE(sides.valid);
  const auto answer = test::ask_fast(s, ids);
  REQUIRE(t.dimension() == answer.dimension);
  if (t.dimension() < Dim) return;
  const auto ours = test::visible(t);
  std::vector<int> differ;
  std::set_symmetric_difference(ours.begin(), ours.end(), answer.visible.begin(),
                                answer.visible.end(), std::back_inserter(differ));
  for (const int i : differ) {
    CAPTURE(i);
    REQUIRE(sides.tied[static_cast<std::size_t>(i)]);
  }
  if (sides.ties()) return;
  REQUIRE(test::edges(t) == answer.edges);
  REQUIRE(simplices(t) == answer.simplices);
}

/// On copies: the checks ask for the edges, which updates their list.
template <int Dim>
void check(const Triangulation<Dim>& triangulation, const test::SiteSet<Dim>& s,
           const std::vector<Edge>& ends_before) {
  // The others may crash where this one finds a defect.
  REQUIRE(test::audited(Triangulation<Dim>(triangulation)) == "");
  const Triangulation<Dim> t = triangulation;  // NOLINT: a copy on purpose, as said above
  REQUIRE(untold(t, ends_before) == "");
  REQUIRE(edge_faults(t) == "");
  const auto ids = present(t);
  REQUIRE(test::same(t, built_of(s, ids)));
  check_against_cgal(t, s, ids);
}

struct Totals {
  UpdateReport report;
  int updates = 0;
  int tiny_or_flat = 0;
};

template <int Dim>
void play(int seed, int steps, Totals& totals) {
  CAPTURE(seed);
  Script<Dim> script(seed);
  auto& t = script.triangulation();
  for (int step = 0; step < steps; ++step) {
    CAPTURE(step);
    totals.tiny_or_flat += tiny_or_flat(t);
    const auto before = ends(t);
    const UpdateReport report = script.update();
    check(t, script.sites(), before);
    // Else the list of edges is left for a later update to see to.
    if (step % 4 == 0) t.edges();
    totals.report += report;
    ++totals.updates;
  }
}

struct Place {
  int id;
  Vec<3> x;
  double w;
};
using Moves = std::vector<std::vector<Place>>;

/// Calls after(t, sites, ends(t) before the move) after each move.
template <class F>
void replay(test3::Sites s, const Moves& moves, F&& after) {
  auto t = test::built(s);
  for (std::size_t k = 0; k < moves.size(); ++k) {
    CAPTURE(k);
    std::vector<int> ids;
    for (const auto& [id, x, w] : moves[k]) {
      ids.push_back(id);
      s.x.col(id) = x;
      s.w[id] = w;
    }
    const auto before = ends(t);
    t.move(ids, s.x, s.w);
    after(t, s, before);
  }
}

}  // namespace

TEST_SUITE("ladder of updates") {
  TEST_CASE_TEMPLATE("scripts that climb every rung", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    CAPTURE(Dim);
    // In the plane flips get stuck less often, and updates cost less.
    const int scripts = Dim == 2 ? test::cases(1000, 100000) : test::cases(400, 40000);
    Totals totals;
    for (int seed = 0; seed < scripts; ++seed) play<Dim>(seed, 200, totals);

    const UpdateReport& r = totals.report;
    MESSAGE("dimension " << Dim << ", " << totals.updates << " updates, " << totals.tiny_or_flat
                         << " of them of tiny or flat sets: flips " << r.flips << ", extracted "
                         << r.extracted << ", unstuck " << r.unstuck << ", reinserted "
                         << r.reinserted << ", rebuilds " << r.rebuilds);
    CHECK(4 * totals.tiny_or_flat < totals.updates);
    CHECK(r.extracted >= 10000);
    CHECK(r.unstuck >= test::cases(Dim == 2 ? 30 : 500, 1000));
    CHECK(r.reinserted >= 10000);
    CHECK(r.rebuilds >= test::cases(500, 1000));
  }

  TEST_CASE("the list of edges is right after cavities were filled anew") {
    const auto s = test3::make_sites(
        "lattice", {{2, 0, 2, 50}, {0, 1, 0, 1}, {0, 1, 1, 1}, {1, 0, 2, 1}, {2, 1, 0, 1},
                    {1, 2, 1, 0},  {0, 0, 0, 0}, {0, 1, 0, 1}, {1, 2, 1, 0}, {2, 1, 2, 2},
                    {0, 1, 2, 0},  {1, 1, 0, 2}, {0, 0, 0, 2}, {2, 0, 1, 0}, {0, 1, 2, 2},
                    {2, 1, 2, 2},  {2, 1, 0, 0}, {2, 0, 0, 0}, {0, 0, 2, 2}, {0, 2, 0, 0}});
    const Moves moves{
        {{5, {1, 3, 0.5}, 0}},
        {{11, {1, 0.5, -0.5}, 2}},
        {{10, {0.5, 1, 2.5}, 0}},
        {{4, {1.5, 1, -0.5}, 1}, {0, {3, 0.5, 2}, 50}},
        {{2, {-0.5, 2, 0.5}, 1}},
        {{1, {-1, 1, 0.5}, 1}},
        {{5, {1.5, 3, 0}, 0}},
        {{18, {-1, 0, 3}, 2}},
        {{19, {1, 2, 1}, 0}},
        {{0, {2.5, 0, 1.5}, 50},
         {1, {0, 1.5, 0}, 1},
         {2, {0, 1, 0.5}, 1},
         {6, {-1, 0, 1}, 0},
         {7, {-0.5, 1, -1}, 1},
         {10, {1, 0.5, 2}, 0},
         {13, {2, -1, 2}, 0},
         {14, {0, 0.5, 3}, 2},
         {15, {3, 0.5, 2}, 2},
         {18, {-1, 0.5, 2}, 2}},
        {{2, {-1, 1, 1}, 1}},
        {{13, {2, 0, 2}, 0}},
    };
    replay(s, moves, [](const Triangulation<3>& t, const auto&, const auto&) {
      CHECK(edge_faults(t) == "");
    });
  }

  TEST_CASE("a site within a cavity that is filled anew is not lost") {
    const auto s = test3::make_sites(
        "general", {{2.71, 0.06, 3.9, 1.96},  {2.46, 0.86, 2.82, 0.44}, {1.5, 3.42, 3.3, 0.33},
                    {3.99, 0.33, 2.54, 1.31}, {2.99, 1.63, 0.09, 1.64}, {0.7, 3.49, 1.13, 33.02},
                    {3.08, 3.31, 2.63, 1.92}, {0.48, 3.36, 3.55, 1.76}, {2.82, 0.4, 2, 0.83},
                    {1.71, 0.47, 0.64, 1.45}, {2.73, 1.43, 3.71, 0.12}, {0.17, 0.85, 0.75, 1.52},
                    {0.7, 2.77, 3.65, 0.14},  {3.16, 3.09, 3.33, 0.27}, {1.03, 0.33, 3.79, 0.7},
                    {2.25, 2.69, 0.4, 47.91}, {0.93, 0.71, 2.09, 1.04}, {3.8, 3.03, 1.87, 0.17},
                    {1.7, 1.8, 3.59, 0.93},   {3.68, 3.84, 1.8, 1.96}});
    const Moves moves{
        {{5, {0.49, 3.7, 1.05}, 33.02},
         {6, {2.6, 3.72, 2.28}, 1.92},
         {7, {0.38, 3.28, 3.89}, 1.76},
         {12, {0.41, 3.13, 4.08}, 0.14},
         {16, {0.44, 0.35, 2.24}, 1.04}},
        {{0, {0.74, 0.21, 0.45}, 1.96}},
        {{1, {3.06, 0.69, 3.16}, 0.44},
         {2, {1.94, 3.95, 3.79}, 0.33},
         {3, {3.04, 0.17, 2.54}, 1.31},
         {11, {-0.72, -0.03, 1.67}, 1.52},
         {12, {0.78, 2.8, 4.51}, 0.14},
         {14, {2.33, 2.26, 0.44}, 0.7},
         {15, {2.51, 2.59, 0.24}, 47.91},
         {16, {0.58, 0.44, 1.81}, 1.04},
         {18, {1.89, 2.57, 4.35}, 0.93}},
        {{10, {3.23, 2.66, 2.86}, 0.12},
         {11, {3.66, 2.14, 1.72}, 1.52},
         {12, {2.86, 2.19, 1.19}, 0.14},
         {18, {0.28, 2.98, 2.83}, 0.93},
         {19, {1.06, 0.35, 3.72}, 1.96}},
    };
    replay(s, moves, check<3>);
  }
}

TEST_SUITE("edge of numbers") {
  TEST_CASE_TEMPLATE(
      "sets far from the origin, near the largest double and among the smallest are triangulated "
      "and audited as they are at hand",
      S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    /// Whole numbers up to kMost in size are shifted, then scaled; all exactly.
    struct Frame {
      const char* name;
      double shift;
      double scale;
    };
    constexpr double kMost = 120;
    const Frame frames[] = {{"at 1e15 radii", 4e15, 1},
                            {"at 1e15 radii, and tiny", -4e15, 0x1p-900},
                            {"near the largest double", 0, 0x1p1016},
                            {"the largest double in a corner", kMost, 0x1p1016},
                            {"subnormal", 0, 0x1p-1074}};
    for (const Frame& frame : frames) {
      for (int seed = 0; seed < test::cases(1, 100); ++seed) {
        Random random(static_cast<std::uint64_t>(seed));
        for (auto at_hand : all_kinds<Dim>(random)) {
          CAPTURE(frame.name);
          CAPTURE(seed);
          CAPTURE(at_hand.name);
          const auto snap = [&](double x) {
            return std::clamp(std::round(4 * x / at_hand.r), -kMost, kMost);
          };
          at_hand.x = at_hand.x.unaryExpr(snap).eval();
          // A weight is a square: where it would over- or underflow there is none.
          at_hand.w = frame.scale == 1
                          ? (16 * at_hand.w / (at_hand.r * at_hand.r)).array().round().eval()
                          : Eigen::ArrayXd::Zero(at_hand.size());
          auto there = at_hand;
          const auto carry = [&](int i) {
            there.x.col(i) = frame.scale * (at_hand.x.col(i).array() + frame.shift).matrix();
          };
          for (int i = 0; i < there.size(); ++i) carry(i);
          auto expected = test::built(at_hand);
          auto t = test::built(there);
          for (int step = 0; step < 8; ++step) {
            CAPTURE(step);
            REQUIRE(test::audited(t) == "");
            REQUIRE(test::same(t, expected));
            const int one = random.below(there.size());
            if (step % 4 == 3) {
              t.remove(one);
              expected.remove(one);
              t.insert(one, there.x.col(one), there.w[one]);
              expected.insert(one, at_hand.x.col(one), at_hand.w[one]);
              continue;
            }
            auto moved = test::some_ids(random, there.size(), step % 4 == 0 ? 1 : 0.1);
            moved.push_back(one);
            for (const int i : moved) {
              for (int axis = 0; axis < Dim; ++axis) {
                double& x = at_hand.x(axis, i);
                x = std::clamp(x + random.below(7) - 3, -kMost, kMost);
              }
              carry(i);
            }
            t.move(moved, there.x, there.w);
            expected.move(moved, at_hand.x, at_hand.w);
          }
        }
      }
    }
  }

  TEST_CASE_TEMPLATE("coordinates of all sizes at once, from the smallest to the largest", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (int seed = 0; seed < test::cases(40, 4000); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      test::SiteSet<Dim> s{"all sizes", Columns<Dim>(Dim, 30), Eigen::VectorXd(30)};
      const auto number = [&] {
        return std::ldexp(random.uniform(-1, 1), random.below(2 * 1023) - 1023);
      };
      const auto place = [&](int i) {
        for (int axis = 0; axis < Dim; ++axis) s.x(axis, i) = number();
        s.w[i] = std::abs(number());
      };
      for (int i = 0; i < s.size(); ++i) place(i);
      auto t = test::built(s);
      const auto ids = test::all_ids(s.size());
      for (int step = 0; step < 10; ++step) {
        CAPTURE(step);
        REQUIRE(test::audited(t) == "");
        check_against_cgal(t, s, ids);
        const std::vector<int> moved{random.below(s.size()), random.below(s.size())};
        for (const int i : moved) place(i);
        t.move(moved, s.x, s.w);
      }
    }
  }
}
