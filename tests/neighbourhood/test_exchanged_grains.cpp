// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/triangulation_neighbourhood.hpp>

#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>

#include <support/cases.hpp>
#include <support/exchanges.hpp>
#include <support/space.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

TEST_SUITE("grains that come and leave, triangulated") {
  TEST_CASE_TEMPLATE("random exchanges are those of brute force, bit for bit", C,
                     Case<2, FrictionalSpring>, Case<2, LinearSpring>, Case<3, FrictionalHertz>,
                     Case<3, ViscousSpring>) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>(kGravel);
    for (int seed = 0; seed < cases(1, 20); ++seed) {
      CAPTURE(seed);
      const auto s = static_cast<std::uint64_t>(seed);
      for (const auto& scene : {settling_bed<Dim>(60, s), stirring<Dim>(60, s)}) {
        for (const bool leap : {false, true}) {
          CAPTURE(leap);
          Random random(s);
          auto reference = start<Dim>(scene, law, AllPairs<Dim>{});
          auto sim =
              start<Dim>(scene, law, TriangulationNeighbourhood<Dim>(Laziness{.leap = leap}));
          check_exchanges<Dim>(sim, reference, 30, 40, random);
          CHECK(sim.neighbourhood().triangulation().size() == sim.grains().size());
        }
      }
    }
  }

  TEST_CASE_TEMPLATE("no contact is missed where grains come and leave", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(2);
    const auto scene = stirring<Dim>(100, 2);
    auto sim =
        start<Dim>(scene, make_law<FrictionalSpring>(kGravel), TriangulationNeighbourhood<Dim>{});
    std::int64_t contacts = 0;
    for (int k = 0; k < 20; ++k) {
      const auto traffic = random_traffic<Dim>(sim, 0.1, random);
      sim.exchange(traffic.leavers, make_grains<Dim, FrictionalSpring::needs>(traffic.newcomers));
      const AuditResult result = audited<Dim>(sim, 100);
      contacts += result.contacts;
      CHECK(result.missed == 0);
    }
    CHECK(contacts > 0);
  }

  TEST_CASE_TEMPLATE("the last grain leaves, and others come", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    constexpr Needs needs = FrictionalSpring::needs;
    const auto scene = settling_bed<Dim>(20, 4);
    const auto law = make_law<FrictionalSpring>(kGravel);
    auto sim = start<Dim>(scene, law, TriangulationNeighbourhood<Dim>{});
    auto reference = start<Dim>(scene, law, AllPairs<Dim>{});
    for (int round = 0; round < 3; ++round) {
      sim.step(300);
      reference.step(300);
      REQUIRE(same_bits(sim, reference));
      std::vector<int> everybody;
      for (int i = 0; i < sim.grains().size(); ++i) everybody.push_back(i);
      sim.exchange(everybody, make_grains<Dim, needs>({}));
      reference.exchange(everybody, make_grains<Dim, needs>({}));
      CHECK(sim.neighbourhood().triangulation().size() == 0);
      sim.step(10);
      reference.step(10);
      sim.exchange({}, make_grains<Dim, needs>(scene.grains));
      reference.exchange({}, make_grains<Dim, needs>(scene.grains));
    }
  }
}
