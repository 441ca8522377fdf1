// SPDX-License-Identifier: GPL-3.0-or-later
// What teaching pages call, compiled for this machine. The functions have no header that lists all:
// JavaScript needs none, and one file says what they do.
#include "../../figures/teach/lab.cpp"

#include <lagrain/all_pairs.hpp>

#include "support/tolerance.hpp"

#include <doctest/doctest.h>

#include <set>

using lagrain::test::relative_error;

namespace {

/// Writes numbers where a page does.
void put(const std::vector<double>& numbers) {
  double* room = lagrain_input(static_cast<int>(numbers.size()));
  REQUIRE(room != nullptr);
  std::copy(numbers.begin(), numbers.end(), room);
}
bool build(const std::vector<double>& numbers, int rule = 0) {
  put(numbers);
  return discs_build(static_cast<int>(numbers.size() / 3), rule) == 1;
}

/// Discs in a box of side 1 that hardly overlap: some touch.
std::vector<double> packed(Random& random, int count) {
  std::vector<Disc> list;
  while (static_cast<int>(list.size()) < count) {
    Disc disc{random.uniform(), random.uniform(), random.uniform(0.02, 0.2)};
    for (const Disc& other : list) {
      disc.r = std::min(disc.r, std::hypot(disc.x - other.x, disc.y - other.y) - 0.99 * other.r);
    }
    if (disc.r > 0.01) list.push_back(disc);
  }
  std::vector<double> numbers;
  for (const Disc& disc : list) numbers.insert(numbers.end(), {disc.x, disc.y, disc.r});
  return numbers;
}

using Edges = std::set<std::pair<int, int>>;
Edges edges_now() {
  const int count = discs_edges();
  Edges edges;
  for (int k = 0; k < count; ++k) {
    edges.insert({lagrain_ints()[2 * k], lagrain_ints()[2 * k + 1]});
  }
  return edges;
}
int contacts_missed() {
  const int count = discs_contacts();
  int missed = 0;
  for (int k = 0; k < count; ++k) missed += lagrain_ints()[3 * k + 2] == 0;
  return missed;
}
/// All that a page can see of the discs.
std::tuple<std::vector<double>, Edges, std::vector<int>, std::vector<int>> seen() {
  discs_believed();
  const std::vector<double> believed = reals;
  discs_hidden();
  const std::vector<int> hidden = ints;
  discs_contacts();
  return {believed, edges_now(), hidden, ints};
}
bool says(const std::string& part) {
  return std::string(lagrain_error()).find(part) != std::string::npos;
}
std::vector<double> report() {
  REQUIRE(grains_report() == 16);
  return reals;
}
/// Places of its numbers.
namespace entry {
constexpr std::size_t kinetic = 0, gravity = 1, unaccounted = 7, contacts = 8, audited = 14,
                      missed = 15;
}
std::pair<int, int> hash() {
  REQUIRE(grains_hash() == 1);
  return {ints[0], ints[1]};
}

}  // namespace

TEST_SUITE("lab") {
  TEST_CASE("a bad input ends in a sentence, and what was there stands") {
    Random random(1);
    REQUIRE(build(packed(random, 20)));
    const auto before = seen();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    const auto refused = [&](bool failed, const std::string& part) {
      CAPTURE(part);
      CAPTURE(lagrain_error());
      CHECK(failed);
      CHECK(says(part));
      CHECK(seen() == before);
    };

    for (const double bad : {nan, infinity, -infinity}) {
      refused(!build({0, 0, 1, 3, bad, 1}), "disc 1");
      refused(discs_move(3, bad, 0, 1) == 0, "disc 3");
      refused(discs_move(3, 0, 0, bad) == 0, "disc 3");
      refused(discs_events(3, 0, bad, 1) == -1, "disc 3");
    }
    refused(!build({0, 0, 0, 3, 0, 1}), "radius 0");
    refused(discs_move(3, 0, 0, -1) == 0, "radius -1");
    refused(discs_move(3, 1e300, 0, 1) == 0, "further away");
    refused(!build(std::vector<double>(30000, 1.5)), "not 10000");
    refused(!build(std::vector<double>(300, 1.5)), "at one point");
    refused(!build({1, 1, 1, 3, 1, 1}, 4), "no rule 4");
    refused(discs_build(7, 0) == 0, "fewer");  // there are two in the input
    refused(discs_build(-1, 0) == 0, "not -1");
    refused(discs_move(20, 0, 0, 1) == 0, "no disc 20");
    refused(discs_move(-1, 0, 0, 1) == 0, "no disc -1");
    refused(discs_move_all(2) == -1, "2 places for 20 discs");
    refused(discs_circle(0, 1, 99) == 0, "no disc 99");
    refused(discs_cells(0, 0, 0, 1) == 0, "empty");
    refused(discs_cells(0, 0, nan, 1) == 0, "empty");
    refused(std::isnan(discs_power(20, 0, 0)), "no disc 20");
    refused(sign_orientation(0, 0, 1, 0, nan, 0) == -2, "not a number");
    refused(sign_map(0, 0.5, 0.5, 12, 12, 24, 24) == -1, "1 to 512");
    put({0, 0, 0, 1, 1, 0, 2, 2, 0, 5, 5, 0});
    refused(sign_power() == -2, "on a line");
    refused(sign_map_power(4) == -1, "counter-clockwise");
    put({0, 0});
    refused(sign_power() == -2, "12 are needed");
    refused(lagrain_input(-1) == nullptr, "-1 numbers");

    // One disc through the other: on the way both are at one point.
    REQUIRE(build({0, 0, 0.5, -1, 0, 0.25}));
    CHECK(discs_events(1, 1, 0, 0.25) > 0);
    REQUIRE(build({0, 0, 1}));
    CHECK(discs_edges() == 0);
    REQUIRE(discs_cells(0, 0, 1, 1) == 1);
    CHECK(ints[0] == 4);

    REQUIRE(build(packed(random, 20)));
    CHECK(discs_move(3, 0.5, 0.5, 0.01) == 1);
    CHECK(std::string(lagrain_error()).empty());
    CHECK(discs_audit() == 0);
  }

  TEST_CASE("events of a straight way come in their order, and each is what happens to T") {
    Random random(2);
    int all = 0, hidings = 0;
    for (int trial = 0; trial < 20; ++trial) {
      const auto numbers = packed(random, 25);
      const Disc from{numbers[0], numbers[1], numbers[2]};
      const Disc to{random.uniform(), random.uniform(), random.uniform(0.02, 0.4)};
      REQUIRE(build(numbers));
      Edges edges = edges_now();
      const int count = discs_events(0, to.x, to.y, to.r);
      REQUIRE(count >= 0);
      const std::vector<double> instants = reals;
      const std::vector<int> words = ints;
      REQUIRE(static_cast<int>(instants.size()) == count);
      const Edges last = edges_now();
      CHECK(discs_audit() == 0);
      CHECK(std::is_sorted(instants.begin(), instants.end()));

      std::size_t at = 0;
      for (std::size_t k = 0; k < instants.size(); ++k) {
        const int gone = words[at], made = words[at + 1];
        hidings += gone == 3 && made == 0;
        at += 2;
        for (int e = 0; e < gone; ++e, at += 2) CHECK(edges.erase({words[at], words[at + 1]}) == 1);
        for (int e = 0; e < made; ++e, at += 2) {
          CHECK(edges.insert({words[at], words[at + 1]}).second);
        }
        // Half-way to the next event T is what the events so far have made of it.
        const double next = k + 1 < instants.size() ? instants[k + 1] : 1;
        if (next - instants[k] < 1e-4) continue;
        const double t = 0.5 * (instants[k] + next);
        auto halfway = numbers;
        halfway[0] = from.x + t * (to.x - from.x);
        halfway[1] = from.y + t * (to.y - from.y);
        halfway[2] = from.r + t * (to.r - from.r);
        REQUIRE(build(halfway));
        CHECK(edges_now() == edges);
      }
      CHECK(at == words.size());
      CHECK(edges == last);
      all += count;
    }
    CHECK(all > 200);
    CHECK(hidings > 5);
  }

  TEST_CASE("a lattice changes many edges at one instant: that is one event") {
    std::vector<double> numbers{1.5, 1.5, 0.1};
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) numbers.insert(numbers.end(), {1.0 * i, 1.0 * j, 0.3});
    }
    REQUIRE(build(numbers));
    const int count = discs_events(0, 2.5, 1.5, 0.1);
    CHECK(count > 0);
    CHECK(count < 40);
    CHECK(discs_audit() == 0);
  }

  TEST_CASE("r^2 misses no contact, the misprint's sqrt r does") {
    Random random(3);
    int misprint = 0;
    for (int trial = 0; trial < 30; ++trial) {
      const auto numbers = packed(random, 40);
      REQUIRE(build(numbers, 0));
      CHECK(discs_contacts() > 0);
      CHECK(contacts_missed() == 0);
      REQUIRE(build(numbers, 1));
      misprint += contacts_missed();
    }
    CHECK(misprint > 20);
  }

  TEST_CASE("a T that stands still misses contacts until it is brought up to date") {
    Random random(4);
    const auto numbers = packed(random, 30);
    REQUIRE(build(numbers));
    const Edges edges = edges_now();
    REQUIRE(discs_stand_still(1) == 0);
    // The first disc comes to touch one that is no neighbour of it.
    int far = 1;
    while (edges.count({0, far}) != 0) ++far;
    const auto f = static_cast<std::size_t>(3 * far);
    CHECK(discs_events(0, numbers[f] + 0.9 * numbers[f + 2], numbers[f + 1],
                       0.2 * numbers[f + 2]) == 0);
    CHECK(contacts_missed() > 0);
    CHECK(edges_now() == edges);
    discs_believed();
    CHECK(reals == numbers);
    CHECK(discs_move_all(1) == -1);
    CHECK(discs_stand_still(0) > 0);
    CHECK(edges_now().count({0, far}) == 1);
    CHECK(contacts_missed() == 0);
    CHECK(discs_audit() == 0);
  }

  TEST_CASE("the orthogonal circle has the same power to its three discs") {
    Random random(5);
    REQUIRE(build(packed(random, 12)));
    const int count = discs_triangles();
    const std::vector<int> corners = ints;
    for (std::size_t k = 0; k < static_cast<std::size_t>(3 * count); k += 3) {
      REQUIRE(discs_circle(corners[k], corners[k + 1], corners[k + 2]) == 1);
      const auto circle = reals;
      for (std::size_t c = 0; c < 3; ++c) {
        CHECK(relative_error(discs_power(corners[k + c], circle[0], circle[1]), circle[2]) < 1e-9);
      }
    }
    REQUIRE(build({0, 0, 1, 1, 1, 1, 2, 2, 1}));
    CHECK(discs_circle(0, 1, 2) == 0);
    CHECK(says("on a line"));
  }

  TEST_CASE("cells fill the box, and a hidden disc has none") {
    REQUIRE(build({0, 0, 1, 3, 0, 1, 0, 3, 1, 3, 3.2, 1, 0.1, 0, 0.1}));
    REQUIRE(discs_cells(-1, -1, 4, 4) == 1);
    REQUIRE(ints.size() == 5);
    CHECK(ints[4] == 0);
    double area = 0;
    std::size_t at = 0;
    for (const int corners : ints) {
      for (int c = 0; c < corners; ++c) {
        const auto p = at + static_cast<std::size_t>(2 * c);
        const auto q = at + static_cast<std::size_t>(2 * ((c + 1) % corners));
        area += 0.5 * (reals[p] * reals[q + 1] - reals[q] * reals[p + 1]);
      }
      at += static_cast<std::size_t>(2 * corners);
    }
    CHECK(relative_error(area, 25) < 1e-12);
    CHECK(discs_hidden() == 1);
    CHECK(ints[0] == 4);
  }

  TEST_CASE("signs are exact, those of doubles are not") {
    CHECK(sign_orientation(0, 0, 1, 0, 0, 1) == 1);
    CHECK(sign_orientation(0, 0, 0, 1, 1, 0) == -1);
    CHECK(sign_orientation(0.1, 0.1, 0.2, 0.2, 0.7, 0.7) == 0);
    put({0, 0, 0, 2, 0, 0, 0, 2, 0, 2, 2, 0});
    CHECK(sign_power() == 0);
    put({0, 0, 0, 0, 2, 0, 2, 0, 0, 1, 1, 0});
    CHECK(sign_power() == 1);  // whichever way the triangle turns

    const int n = 64;
    const int differ = sign_map(n, 0.5, 0.5, 12, 12, 24, 24);
    CHECK(differ > n * n / 10);
    REQUIRE(ints.size() == 2 * n * n);
    for (int row = 0; row < n; ++row) {
      for (int column = 0; column < n; ++column) {
        const int exact = ints[static_cast<std::size_t>(n * n + row * n + column)];
        CHECK(exact == sign_of(row - column) + 1);
      }
    }
    // The corner of a square is on the circle of the other three.
    put({12, 12, 0, 24, 12, 0, 24, 24, 0, 12, 24, 0});
    CHECK(sign_map_power(n) > 0);
    CHECK(ints[static_cast<std::size_t>(n * n)] == 1);
  }

  TEST_CASE("five points in space have two or three tetrahedra") {
    // Two apexes above and below a triangle: close together they see each other through it.
    const auto tetrahedra = [](double apart) {
      put({1, 0, 0, 0, -0.5, 0.8, 0, 0, -0.5, -0.8, 0, 0, 0, 0, apart, 0, 0, 0, -apart, 0});
      REQUIRE(space_build(5) == 1);
      CHECK(space_count() == 5);
      CHECK(space_audit() == 0);
      CHECK(space_edges() == (space_tetrahedra() == 3 ? 10 : 9));
      return space_tetrahedra();
    };
    CHECK(tetrahedra(0.5) == 3);
    CHECK(tetrahedra(2) == 2);
    CHECK(space_hidden() == 0);

    put({0, 0, 0, 0, std::nan(""), 0, 0, 0});
    CHECK(space_build(2) == 0);
    CHECK(says("number 4"));
    put(std::vector<double>(40, 2));
    CHECK(space_build(10) == 0);
    CHECK(says("at one point"));
    CHECK(space_build(40000) == 0);
    CHECK(space_build(20) == 0);
    CHECK(space_count() == 5);
    CHECK(space_tetrahedra() == 2);

    put({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 1, 1, 0});
    CHECK(sign_orientation3() == 1);
    CHECK(sign_power3() == 0);  // the corner of a cube is on the sphere of four others
    put({1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0.5, 0});
    CHECK(sign_orientation3() == -1);
    CHECK(sign_power3() == 1);
    put({1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 1, 1, 0});
    CHECK(sign_orientation3() == 0);
    CHECK(sign_power3() == -2);
  }

  TEST_CASE("grains of every kind move, no contact is missed, energy is accounted for") {
    for (const int kind : {0, 1, 2, 3}) {
      CAPTURE(kind);
      REQUIRE(grains_start(kind, 100, 1, 0.3, 0.5) == 1);
      CHECK(grains_count() == (kind == 2 ? 1 : 100));
      const double whole = report()[entry::kinetic] + report()[entry::gravity];
      const int calls = kind == 2 ? 1000 : 40;
      for (int k = 0; k < calls; ++k) {
        REQUIRE(grains_step(200) == 1);
        report();
      }
      CHECK(relative_error(grains_time(), 200 * calls * grains_time_step()) < 1e-12);
      const auto now = report();
      CHECK(now[entry::missed] == 0);
      if (kind != 2) CHECK(now[entry::audited] > 0);
      CHECK(std::abs(now[entry::unaccounted]) < 2e-3 * whole);
      CHECK(grains_places() == grains_count());
      CHECK(static_cast<int>(reals.size()) == 4 * grains_count());
      CHECK(std::all_of(reals.begin(), reals.end(), [](double x) { return std::isfinite(x); }));
      CHECK(grains_walls() >= 3);
      CHECK(grains_contacts() >= static_cast<int>(now[entry::contacts]));
      CHECK(reals.size() == ints.size() / 2 * 5);
      CHECK(grains_triangulation() >= 0);
      CHECK(static_cast<int>(reals.size()) == 4 * grains_count());
    }
  }

  TEST_CASE("a bed is at rest from the start") {
    REQUIRE(grains_start(1, 200, 1, 0.5, 0.5) == 1);
    CHECK(report()[entry::kinetic] == 0);
    const double potential = report()[entry::gravity];
    REQUIRE(grains_step(5000) == 1);
    CHECK(relative_error(report()[entry::gravity], potential) < 0.01);
    CHECK(report()[entry::contacts] > 200);
  }

  TEST_CASE("a disc bounces to the square of the restitution") {
    for (const double e : {0.5, 0.9}) {
      REQUIRE(grains_start(2, 1, 1, 0, e) == 1);
      double lowest = 1, highest = 0;
      bool fallen = false;
      for (int k = 0; k < 200000; ++k) {
        REQUIRE(grains_step(1) == 1);
        grains_places();
        const double height = reals[1] - reals[2];
        lowest = std::min(lowest, height);
        if (height < 0) {
          if (highest > 0) break;
          fallen = true;
        }
        if (fallen) highest = std::max(highest, height);
      }
      CHECK(lowest < 0);
      CHECK(relative_error(highest, e * e) < 2e-3);
    }
  }

  TEST_CASE("the hash of the grains is that of the same scene, however it is stepped") {
    const auto run_of = [](int seed, int calls, int steps) {
      REQUIRE(grains_start(0, 150, seed, 0.3, 0.3) == 1);
      for (int k = 0; k < calls; ++k) REQUIRE(grains_step(steps) == 1);
      return hash();
    };
    const auto first = run_of(1, 1, 3000);
    CHECK(run_of(1, 30, 100) == first);
    CHECK(run_of(2, 1, 3000) != first);
    REQUIRE(grains_leap(0) == 1);
    CHECK(run_of(1, 1, 3000) == first);
    REQUIRE(grains_leap(1) == 1);
    REQUIRE(grains_skin(0.5) == 1);
    CHECK(run_of(1, 1, 3000) == first);
    REQUIRE(grains_skin(1.3) == 1);
  }

  TEST_CASE("a T that does not follow the grains misses contacts") {
    REQUIRE(grains_follow(0) == 1);
    REQUIRE(grains_start(0, 150, 1, 0.3, 0.3) == 1);
    REQUIRE(grains_follow(1) == 1);
    for (int k = 0; k < 40 && grains_step(200) == 1; ++k) report();
    CHECK(report()[entry::missed] > 0);
  }

  TEST_CASE("a scene that breaks off says so, and another one can start") {
    REQUIRE(grains_start(0, 50, 1, 0.3, 0.3) == 1);
    CHECK(grains_gravity(std::nan(""), 0) == 0);
    REQUIRE(grains_gravity(0, -1e9) == 1);
    int good = 0;
    while (grains_step(10) == 1 && good < 1000) ++good;
    CHECK(good < 1000);
    CHECK(!std::string(lagrain_error()).empty());
    CHECK(grains_step(1) == 0);
    CHECK(says("broken off"));
    CHECK(grains_places() == 50);

    const auto still_there = grains_count();
    CHECK(grains_start(0, 10000, 1, 0.3, 0.3) == 0);
    CHECK(says("1000"));
    CHECK(grains_start(4, 10, 1, 0.3, 0.3) == 0);
    CHECK(grains_start(0, 10, 1, std::nan(""), 0.3) == 0);
    CHECK(grains_start(0, 10, 1, 0.3, 0) == 0);
    CHECK(grains_start(0, 10, 1, 0.3, 1.5) == 0);
    CHECK(grains_skin(0) == 0);
    CHECK(grains_step(-1) == 0);
    CHECK(grains_count() == still_there);

    CHECK(grains_start(0, 50, 1, 0.3, 0.3) == 1);
    CHECK(grains_step(100) == 1);
  }

  TEST_CASE("all numbers of grains fit into their scenes") {
    for (const int kind : {0, 1, 3}) {
      for (const int n : {1, 2, 13, 1000}) {
        CAPTURE(kind);
        CAPTURE(n);
        REQUIRE(grains_start(kind, n, 3, 0.3, 0.5) == 1);
        CHECK(grains_step(200) == 1);
        CHECK(report()[entry::missed] == 0);
      }
    }
  }

  TEST_CASE_TEMPLATE("the impact of the pages is that of a simulation, bit for bit", Motion,
                     SymplecticEuler, VelocityVerlet, ForestRuth) {
    for (const double e : {1.0, 0.5}) {
      if (Motion::kConservativeOnly && e < 1) continue;
      const double steps = 23.7, phase = 0.3;
      const LinearSpring law = LinearSpring::with_restitution(1, e);
      Setting<2> setting;
      setting.time_step = law.contact_time(0.5, 0.5) / steps;
      std::vector<Grain<2>> list(2);
      for (const int side : {-1, 1}) {
        Grain<2>& grain = list[side < 0 ? 0 : 1];
        grain.radius = grain.mass = 1;
        grain.position = {side * (1 + 0.1 * (setting.time_step * (1 + phase))), 0};
        grain.velocity = {-side * 0.1, 0};
      }
      Simulation<2, LinearSpring, Motion, AllPairs<2>> sim(
          make_grains<2, LinearSpring::needs>(list), LawTable<LinearSpring>(law), {}, setting);
      sim.step(39);
      const double apart = sim.grains().velocity(0, 1) - sim.grains().velocity(0, 0);

      CHECK(impact_errors<Motion>(steps, e, phase).speed == apart / (2 * 0.1 * e) - 1);
    }
  }

  TEST_CASE("errors of an impact fall with the order of the integrator") {
    REQUIRE(impact_integrators() == 3);
    // The onset of the contact, a kink of the force, keeps the last one from its fourth order.
    const double least[] = {2, 12, 15};
    for (int k = 0; k < 3; ++k) {
      CAPTURE(impact_integrator_name(k));
      REQUIRE(impact(k, 20, 1) == 1);
      const auto coarse = reals;
      REQUIRE(impact(k, 80, 1) == 1);
      CHECK(coarse[0] / reals[0] > least[k]);
      CHECK(coarse[1] / reals[1] > least[k]);
      CHECK(relative_error(reals[2], 4 * coarse[2]) < 1e-12);
    }
    CHECK(std::string(impact_integrator_name(3)).empty());
    CHECK(impact(3, 20, 1) == 0);
    CHECK(impact(2, 20, 0.5) == 0);
    CHECK(says("restitution 1"));
    CHECK(impact(1, 1, 0.5) == 0);
    CHECK(impact(1, 20, 0) == 0);
    CHECK(impact(1, std::nan(""), 0.5) == 0);
  }
}
