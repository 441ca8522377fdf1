// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/triangulation3.hpp>

#include "dim3/sets3.hpp"
#include "support/cases.hpp"
#include "support/triangulation_laws.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace lagrain;
using test::Edge;

TEST_SUITE("triangulation3") {
  TEST_CASE("sites inserted one by one into nothing give the triangulation that build gives") {
    for (int seed = 0; seed < test::cases(4, 200); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      for (const auto& s : test3::all_kinds(random)) test::check_insertions(s);
    }
  }

  TEST_CASE("a move gives the triangulation that build gives, and moving back the former one") {
    for (int seed = 0; seed < test::cases(2, 60); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      for (const auto& s : test3::all_kinds(random)) test::check_moves(s, random);
    }
  }

  TEST_CASE("a disordered set that moves by at most 0.05 radii is never built anew") {
    for (int seed = 0; seed < test::cases(2, 100); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      for (auto& s : test3::disordered_kinds(random, 7)) {
        auto t = test::built(s);
        for (const double distance : {0.01, 0.05}) {
          for (const double fraction : {0.0, 0.02, 0.3, 1.0}) {
            CAPTURE(seed);
            CAPTURE(s.name);
            CAPTURE(distance);
            CAPTURE(fraction);
            auto ids = test::some_ids(random, s.size(), fraction);
            if (ids.empty()) ids = {random.below(s.size())};
            s = test::displaced(s, ids, distance * s.r, random);

            const UpdateReport report = t.move(ids, s.x, s.w);

            CHECK(report.rebuilds == 0);
            CHECK_AS_BUILT(t, s);
          }
        }
      }
    }
  }

  TEST_CASE("weights may change, hiding sites and showing them again") {
    for (int seed = 0; seed < test::cases(5, 300); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      test::check_weights(test3::jittered(random, 6), 0.1, random);
    }
  }

  TEST_CASE("all weights may change at once, where flips get stuck") {
    UpdateReport total;
    for (int seed = 0; seed < test::cases(4, 200); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      auto s = test3::jittered(random, 7);
      auto t = test::built(s);
      for (const double range : {0.1, 1.0, 4.0, 16.0, 16.0, 16.0, 0.0}) {
        CAPTURE(range);
        for (int i = 0; i < s.size(); ++i) s.w[i] = random.uniform(0, range);

        total += t.move(test::all_ids(s.size()), s.x, s.w);

        CHECK_AS_BUILT(t, s);
      }
    }
    CHECK(total.unstuck > 0);
  }

  TEST_CASE("a crystal shaken out of order and back") {
    UpdateReport total;
    for (int seed = 0; seed < test::cases(3, 100); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      for (const auto& lattice :
           {test3::fcc_lattice(9, 1), test3::hcp_lattice(7, 1), test3::cubic_lattice(7, 1)}) {
        CAPTURE(lattice.name);
        const auto all = test::all_ids(lattice.size());
        auto s = test::displaced(lattice, all, 0.001 * lattice.r, random);
        auto t = test::built(s);
        for (const double distance : {0.01, 0.03, 0.1, 0.1}) {
          CAPTURE(distance);
          s = test::displaced(s, all, distance * lattice.r, random);

          total += t.move(all, s.x, s.w);

          CHECK_AS_BUILT(t, s);
        }
        total += t.move(all, lattice.x, lattice.w);
        CHECK_AS_BUILT(t, lattice);
      }
    }
    CHECK(total.extracted > 0);
  }

  TEST_CASE("the unit of length does not matter, however large or small") {
    Random random(13);
    for (const auto& s : test3::all_kinds(random, 3)) {
      const auto expected = test::built(s);
      for (const int power : {-400, -250, -60, 60, 250, 400}) {
        CAPTURE(s.name);
        CAPTURE(power);
        auto scaled = s;
        scaled.x *= std::ldexp(1.0, power);
        scaled.w *= std::ldexp(1.0, 2 * power);

        auto t = test::built(scaled);

        CHECK(test::audited(t) == "");
        CHECK(test::same(t, expected));
        const std::vector<int> one{random.below(s.size())};
        const auto moved = test::displaced(scaled, one, std::ldexp(s.r, power), random);
        t.move(one, moved.x, moved.w);
        CHECK_AS_BUILT(t, moved);
      }
    }
  }

  TEST_CASE(
      "any sequence of moves, insertions and removals ends in the triangulation of what is there") {
    for (int seed = 0; seed < test::cases(3, 100); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      for (const auto& s : test3::all_kinds(random)) test::check_sequence(s, random);
    }
  }

  TEST_CASE("any sequence of batches that move, weigh, snap, flatten and heap up sites") {
    for (int seed = 0; seed < test::cases(40, 500); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      const auto kinds = test3::all_kinds(random, 3 + random.below(2));
      auto s = kinds[static_cast<std::size_t>(random.below(static_cast<int>(kinds.size())))];
      CAPTURE(s.name);
      auto t = test::built(s);
      for (int step = 0; step < 15; ++step) {
        CAPTURE(step);
        const int what = random.below(7);
        auto ids = test::some_ids(random, s.size(), random.uniform() < 0.3 ? 1 : 0.1);
        if (ids.empty()) ids = {0};
        const double distance = s.r * std::pow(10.0, random.uniform(-14, 3));
        const Vec<3> corner = s.x.col(ids[0]);
        for (const int i : ids) {
          const int axis = random.below(3);
          if (what == 0) s.x.col(i) += distance * test::random_direction<3>(random);
          if (what == 1) s.x.col(i) += 0.1 * s.r * test::random_direction<3>(random);
          if (what == 2) s.w[i] *= random.uniform(0, 2.5);
          if (what == 3) s.x(axis, i) = std::round(s.x(axis, i) / s.r) * s.r;
          if (what == 4) s.x(axis, i) = corner[axis];
          if (what == 5) s.x(axis, i) = std::max(s.x(axis, i), corner[axis]);
          if (what == 6) s.x.col(i) = s.x.col(random.below(s.size()));
        }

        t.move(ids, s.x, s.w);

        CHECK_AS_BUILT(t, s);
      }
    }
  }

  TEST_CASE("a set taken away site by site is a triangulation all the way") {
    for (int seed = 0; seed < test::cases(2, 100); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      for (const auto& s : test3::all_kinds(random, 3)) {
        auto t = test::built(s);
        auto ids = test::all_ids(s.size());
        while (!ids.empty()) {
          CAPTURE(seed);
          CAPTURE(s.name);
          CAPTURE(ids.size());
          std::swap(ids[static_cast<std::size_t>(random.below(static_cast<int>(ids.size())))],
                    ids.back());
          t.remove(ids.back());
          ids.pop_back();
          CHECK(test::audited(t) == "");
        }
        CHECK(t.dimension() == -1);
      }
    }
  }
}

TEST_SUITE("triangulation3: the hull") {
  TEST_CASE("sites in general position are taken out by flips alone, corners of the hull too") {
    for (int seed = 0; seed < test::cases(5, 100); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      const auto s = test3::jittered(random, 5);
      auto t = test::built(s);
      auto ids = test::all_ids(s.size());
      while (static_cast<int>(ids.size()) > Triangulation<3>::kTiny) {
        CAPTURE(ids.size());
        std::swap(ids[static_cast<std::size_t>(random.below(static_cast<int>(ids.size())))],
                  ids.back());

        const UpdateReport report = t.remove(ids.back());

        ids.pop_back();
        CHECK(report.flips > 0);
        CHECK(report.rebuilds == 0);
        CHECK(test::audited(t) == "");
      }
    }
  }

  TEST_CASE("layers on a floor that shake are never built anew") {
    // On the floor exactly, off it by rounding, and by a millionth.
    for (const double rough : {0.0, 1e-15, 1e-6}) {
      CAPTURE(rough);
      Random random(7);
      test::Rows<3> rows;
      for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < 7; ++j) {
          for (int i = 0; i < 7; ++i) {
            rows.push_back({i + 0.2 * random.uniform(), j + 0.2 * random.uniform(), 1.0 * k, 0.25});
          }
        }
      }
      auto s = test3::make_sites("floor", rows, 0.5);
      auto t = test::built(s);
      UpdateReport total;

      for (int step = 0; step < test::cases(60, 1000); ++step) {
        const auto ids = test::some_ids(random, s.size(), step % 2 == 0 ? 0.05 : 0.4);
        for (const int i : ids) {
          s.x.col(i) += 0.02 * test::random_direction<3>(random);
          s.x(2, i) = std::max(rough * random.uniform(), s.x(2, i));
        }
        total += t.move(ids, s.x, s.w);
        if (step % 10 == 0) CHECK_AS_BUILT(t, s);
      }

      CHECK_AS_BUILT(t, s);
      CHECK(total.rebuilds == 0);
    }
  }

  TEST_CASE("sites that cross the hull, in and out, leave the triangulation that build gives") {
    for (int seed = 0; seed < test::cases(3, 200); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      auto s = test3::jittered(random, 5);
      auto t = test::built(s);
      const Vec<3> middle(4, 4, 4);
      for (int step = 0; step < 30; ++step) {
        CAPTURE(seed);
        CAPTURE(step);
        // Reflected at a sphere about the middle: what was out comes in.
        for (const int i : test::some_ids(random, s.size(), 0.02)) {
          const Vec<3> from = s.x.col(i) - middle;
          s.x.col(i) = middle + 25 / (0.1 + from.squaredNorm()) * from;
        }
        t.move(test::all_ids(s.size()), s.x, s.w);
        CHECK_AS_BUILT(t, s);
      }
    }
  }

  TEST_CASE("a site thrown through the set and far beyond it is found on the other side") {
    for (const double far : {10.0, 1e3, 1e6, 1e9}) {
      for (int seed = 0; seed < test::cases(4, 200); ++seed) {
        CAPTURE(far);
        CAPTURE(seed);
        Random random(static_cast<std::uint64_t>(seed));
        const auto s = test3::jittered(random, 4);
        auto t = test::built(s);
        auto thrown = s;
        const int i = random.below(s.size()), j = (i + 1 + random.below(s.size() - 1)) % s.size();
        const auto throw_site = [&](int site, double distance) {
          thrown.x.col(site) = Vec<3>(3, 3, 3) + distance * (Vec<3>(3, 3, 3) - s.x.col(site));
          t.move(std::vector<int>{site}, thrown.x, thrown.w);
          CHECK_AS_BUILT(t, thrown);
        };

        throw_site(i, far);
        throw_site(i, -far);
        throw_site(j, far);
        throw_site(j, 1 / far);
        // One comes back as the other leaves.
        thrown.x.col(i) = s.x.col(i);
        thrown.x.col(j) = Vec<3>(-3 * far, far, 2 * far);
        t.move(std::vector<int>{i, j}, thrown.x, thrown.w);
        CHECK_AS_BUILT(t, thrown);
        t.move(std::vector<int>{j}, s.x, s.w);
        CHECK_AS_BUILT(t, s);
      }
    }
  }

  TEST_CASE("a set that drifts, turns, grows or is mirrored as a whole") {
    Random random(3);
    for (const auto& s : test3::disordered_kinds(random, 5)) {
      CAPTURE(s.name);
      const auto ids = test::all_ids(s.size());
      auto t = test::built(s);
      auto other = s;
      const auto check = [&](const Columns<3>& x) {
        other.x = x;
        t.move(ids, other.x, other.w);
        CHECK_AS_BUILT(t, other);
      };

      check(s.x.colwise() + Vec<3>(100, 3, -1000) * s.r);
      check(3 * s.x);
      check(Eigen::AngleAxisd(0.3, Vec<3>(1, 2, 3).normalized()).toRotationMatrix() * s.x);
      check(-s.x);
      check(s.x.colwise().reverse());
    }
  }
}

TEST_SUITE("triangulation3: few and flat sets") {
  TEST_CASE("sets of no, one, two, three, four and five sites are triangulations") {
    Triangulation<3> t;
    CHECK(t.dimension() == -1);
    CHECK(t.size() == 0);
    CHECK(t.audit().empty());

    t.insert(0, Vec<3>(1, 1, 1), 1);
    CHECK(t.dimension() == 0);
    t.insert(1, Vec<3>(2, 2, 2), 1);
    CHECK(t.dimension() == 1);
    CHECK(test::edges(t) == std::vector<Edge>{{0, 1}});
    t.insert(2, Vec<3>(4, 4, 4), 1);
    CHECK(t.dimension() == 1);
    CHECK(test::edges(t) == std::vector<Edge>{{0, 1}, {1, 2}});
    t.insert(3, Vec<3>(4, 5, 4), 1);
    CHECK(t.dimension() == 2);
    CHECK(test::edges(t) == std::vector<Edge>{{0, 1}, {0, 3}, {1, 2}, {1, 3}, {2, 3}});
    CHECK(test::tetrahedra(t).empty());
    t.insert(4, Vec<3>(0, 0, 9), 1);
    CHECK(t.dimension() == 3);
    CHECK(test::tetrahedra(t).size() == 2);
    CHECK(t.audit().empty());
    t.remove(4);
    CHECK(t.dimension() == 2);
    t.remove(3);
    CHECK(t.dimension() == 1);
    t.remove(0);
    t.remove(1);
    t.remove(2);
    CHECK(t.dimension() == -1);
    CHECK(t.size() == 5);
    CHECK(t.audit().empty());
    t.build(Columns<3>(3, 0), Eigen::VectorXd(0));
    CHECK(t.size() == 0);
  }

  TEST_CASE("many sites fall on one plane, one line and one place, and leave them again") {
    Random random(5);
    for (const auto& s : {test3::jittered(random, 4), test3::overlapping(random, 60)}) {
      CAPTURE(s.name);
      const auto ids = test::all_ids(s.size());
      auto t = test::built(s);
      auto flat = s;
      for (int axis = 0; axis < 3; ++axis) {
        CAPTURE(axis);
        flat.x.row(axis).setConstant(2.5);

        t.move(ids, flat.x, flat.w);
        CHECK(t.dimension() == 2 - axis);
        CHECK_AS_BUILT(t, flat);
        t.move(ids, s.x, s.w);
        CHECK(t.dimension() == 3);
        CHECK_AS_BUILT(t, s);
        t.move(ids, flat.x, flat.w);
        CHECK_AS_BUILT(t, flat);
      }
      t.move(ids, s.x, s.w);
      CHECK_AS_BUILT(t, s);
    }
  }

  TEST_CASE("the one site off a plane holds up the third dimension") {
    for (int seed = 0; seed < test::cases(3, 100); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      for (auto s :
           {test3::coplanar(random, 40, {1, 0, 0}, {0, 1, 0}),
            test3::coplanar(random, 40, {1, -1, 0}, {0, 2, -3}), test3::cubic_lattice(3, 1)}) {
        CAPTURE(seed);
        CAPTURE(s.name);
        if (s.name == "cubic lattice") s.x.row(2).setZero();
        const Vec<3> in_plane = s.x.col(7);
        s.x.col(7) += Vec<3>(0.5, 0.25, 3);
        s.w[7] = 5;
        auto t = test::built(s);
        CHECK(t.dimension() == 3);

        t.remove(7);
        CHECK(t.dimension() == 2);
        CHECK(test::audited(t) == "");
        t.insert(7, s.x.col(7), s.w[7]);
        CHECK_AS_BUILT(t, s);

        auto flat = s;
        flat.x.col(7) = in_plane;
        t.move(std::vector<int>{7}, flat.x, flat.w);
        CHECK(t.dimension() == 2);
        CHECK_AS_BUILT(t, flat);
        t.move(std::vector<int>{7}, s.x, s.w);
        CHECK_AS_BUILT(t, s);

        // Straight through the plane to the other side, all others at rest.
        auto mirrored = s;
        mirrored.x.col(7) = 2 * in_plane - s.x.col(7);
        t.move(std::vector<int>{7}, mirrored.x, mirrored.w);
        CHECK(t.dimension() == 3);
        CHECK_AS_BUILT(t, mirrored);
      }
    }
  }

  TEST_CASE("two sites off a plane may leave one after the other, or both at once") {
    Random random(4);
    auto s = test3::coplanar(random, 60, {1, 0, 0}, {0, 1, 0});
    auto flat = s;
    s.x(2, 7) = 1;
    s.x(2, 8) = -1;
    auto t = test::built(s);

    t.move(std::vector<int>{7, 8}, flat.x, flat.w);
    CHECK_AS_BUILT(t, flat);
    t.move(std::vector<int>{7, 8}, s.x, s.w);
    CHECK_AS_BUILT(t, s);
    t.move(std::vector<int>{8}, flat.x, flat.w);
    CHECK(t.dimension() == 3);
    CHECK(test::audited(t) == "");
    t.move(std::vector<int>{7}, flat.x, flat.w);
    CHECK_AS_BUILT(t, flat);
  }

  TEST_CASE("of coincident centres the heaviest is seen, of equal ones the last") {
    const auto one = test::built(test3::make_sites("", {{1, 1, 1, 2}, {1, 1, 1, 3}, {1, 1, 1, 3}}));
    CHECK(one.dimension() == 0);
    CHECK(test::hidden(one) == std::vector<int>{0, 1});

    const auto space = test::built(test3::make_sites("", {{0, 0, 0, 1},
                                                          {5, 0, 0, 1},
                                                          {0, 5, 0, 1},
                                                          {0, 0, 5, 1},
                                                          {1, 1, 1, 2},
                                                          {1, 1, 1, 3},
                                                          {1, 1, 1, 3},
                                                          {1, 1, 1, 1}}));
    CHECK(test::hidden(space) == std::vector<int>{4, 5, 7});
    CHECK(space.audit().empty());
  }

  TEST_CASE("fewer sites are seen than an update needs, and then more again") {
    Random random(12);
    auto s = test3::jittered(random, 3);
    auto t = test::built(s);
    auto covered = s;
    covered.w[13] = 300;

    t.move(std::vector<int>{13}, covered.x, covered.w);
    CHECK(!t.hidden().empty());
    CHECK_AS_BUILT(t, covered);
    covered.x.col(13) += Vec<3>(1, 0.5, 0.25);
    t.move(std::vector<int>{13}, covered.x, covered.w);
    CHECK_AS_BUILT(t, covered);
    t.move(std::vector<int>{13}, s.x, s.w);

    CHECK(t.hidden().empty());
    CHECK_AS_BUILT(t, s);
  }
}

TEST_SUITE("triangulation3: the interface") {
  TEST_CASE("every neighbour relation is an edge, seen from both ends") {
    Random random(2);
    for (const auto& s : test3::all_kinds(random)) test::check_neighbours(s);
  }

  TEST_CASE("an update tells which edges it made") {
    Random random(3);
    for (const auto& s : test3::all_kinds(random)) test::check_new_edges(s, random);
  }

  TEST_CASE("every edge of a tetrahedron is an edge, and there are no others") {
    Random random(9);
    for (const auto& s : test3::disordered_kinds(random, 5)) {
      CAPTURE(s.name);
      const auto t = test::built(s);
      std::vector<Edge> seen;

      for (const auto& four : test::tetrahedra(t)) {
        for (std::size_t k = 0; k < 4; ++k) {
          for (std::size_t l = k + 1; l < 4; ++l) seen.emplace_back(four[k], four[l]);
        }
      }

      std::sort(seen.begin(), seen.end());
      seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
      CHECK(seen == test::edges(t));
    }
  }

  TEST_CASE("a copy is a triangulation of its own") {
    Random random(6);
    const auto s = test3::jittered(random, 4);
    auto t = test::built(s);
    const auto there = test::displaced(s, test::all_ids(s.size()), 0.1, random);
    t.move(test::all_ids(s.size()), there.x, there.w);

    auto copy = t;
    copy.move(test::all_ids(s.size()), s.x, s.w);

    CHECK_AS_BUILT(t, there);
    CHECK_AS_BUILT(copy, s);
    t = copy;
    t.remove(5);
    CHECK(copy.contains(5));
    CHECK_AS_BUILT(copy, s);
    copy = std::move(t);
    CHECK(!copy.contains(5));
    CHECK(test::audited(copy) == "");
  }

  TEST_CASE("a broken contract throws and changes nothing") {
    Random random(1);
    test::check_contracts(test3::jittered(random, 3));
  }
}

TEST_SUITE("contacts in the triangulation of space") {
  TEST_CASE("only the weight r^2 has the touching pair as an edge") {
    // Big spheres that touch across a ring of three small ones.
    const auto has_edge = [](auto weight) {
      test::Rows<3> rows{{0, 0, 9.99, weight(10.0)}, {0, 0, -9.99, weight(10.0)}};
      for (int k = 0; k < 3; ++k) {
        const double angle = 2.0943951023931953 * k;
        rows.push_back({4.7 * std::cos(angle), 4.7 * std::sin(angle), 0, weight(1.0)});
      }
      const auto list = test::edges(test::built(test3::make_sites("", rows)));
      return std::binary_search(list.begin(), list.end(), Edge{0, 1});
    };

    CHECK(has_edge([](double r) { return r * r; }));
    CHECK(!has_edge([](double r) { return r; }));
    CHECK(!has_edge([](double r) { return std::sqrt(r); }));
    CHECK(!has_edge([](double) { return 0.0; }));
  }

  TEST_CASE("every contact is an edge while overlaps stay below 0.58 of the smaller radius") {
    for (int seed = 0; seed < test::cases(10, 500); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      // So dense that most spheres touch others.
      auto s = test3::polydisperse(random, 200, std::pow(10.0, random.uniform(0, 2)), 0.58);
      auto t = test::built(s);

      CHECK(test::missed_contacts(t, s) == 0);
      CHECK(t.hidden().empty());

      const auto ids = test::some_ids(random, s.size(), 0.5);
      for (const int i : ids) s.w[i] *= 0.8;
      t.move(ids, s.x, s.w);

      CHECK(test::missed_contacts(t, s) == 0);
    }
  }

  TEST_CASE("a build sorts sites at the edge of numbers, and with one far away") {
    test::check_edge_of_numbers<3>();
  }
}
