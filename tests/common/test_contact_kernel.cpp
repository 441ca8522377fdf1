// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/compiled_kernels.hpp>
#include <lagrain/contact_kernel.hpp>

#include <lagrain/random.hpp>

#include <support/scenes.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// Grains on a loose lattice: some pairs overlap, some do not, two grains lie on one place, one is
/// pinned. Contacts remember something.
template <int Dim, class Law>
struct Heap {
  static constexpr Needs needs = Law::needs;
  using Memory = typename Law::template Memory<Dim>;

  std::vector<GrainRecord<Dim, needs>> grains;
  std::vector<LoadRecord<Dim, needs>> loads;
  std::vector<std::uint8_t> materials;
  LawTable<Law> laws;
  std::vector<Wall<Dim>> walls;
  PairTable<Pair, Memory> pairs;
  PairTable<WallPair, Memory> wall_pairs;

  Heap(int count, int material_count)
      : grains(static_cast<std::size_t>(count)), loads(grains.size()) {
    using R = GrainRecord<Dim, needs>;
    Random random(static_cast<std::uint64_t>(count + 100 * material_count));
    const auto between = [&](double low, double high) { return random.uniform(low, high); };
    const int side = 4;
    for (int i = 0; i < count; ++i) {
      auto& g = grains[static_cast<std::size_t>(i)];
      int rest = i;
      for (int d = 0; d < Dim; ++d) {
        g.position()[d] = 1.95 * (d == Dim - 1 ? rest : rest % side) + between(-0.1, 0.1);
        g.velocity()[d] = between(-1, 1);
        rest /= side;
      }
      g.at[R::kRadius] = between(0.9, 1);
      g.at[R::kInverseMass] = i == 5 ? 0 : between(0.5, 2);
      loads[static_cast<std::size_t>(i)].at[LoadRecord<Dim, needs>::kMass] = between(0.5, 2);
      if constexpr (needs.spin) {
        for (int d = 0; d < kSpinDim<Dim>; ++d) g.omega()[d] = between(-1, 1);
      }
      if (material_count > 1) materials.push_back(static_cast<std::uint8_t>(i % material_count));
    }
    if (count > 8) grains[8].position() = grains[7].position();

    const auto law = [](double stiffness) {
      return make_law<Law>({.stiffness = stiffness,
                            .restitution = 0.5,
                            .friction = 0.2,
                            .tangential_damping_ratio = 0.3,
                            .rolling_friction = 0.1,
                            .twisting_friction = 0.1});
    };
    laws = LawTable<Law>(law(1e4), material_count);
    if (material_count > 1) {
      laws.set(0, 1, law(2e4));
      laws.set(1, 1, law(5e4));
    }
    walls.push_back(
        Wall<Dim>::half_space("floor", Vec<Dim>::Constant(-0.9), Vec<Dim>::Unit(Dim - 1)));
    walls.push_back(flat_piece<Dim>("bar", -10 * Vec<Dim>::Unit(0), 10 * Vec<Dim>::Unit(0)));
    walls.back().material = material_count - 1;
    walls.back().velocity = 0.1 * Vec<Dim>::Unit(0);
    walls.back().turning = Turn<Dim>{SpinVec<Dim>::Unit(0), 0.2, Vec<Dim>::Zero()};
    walls.back().spin = 0.2 * SpinVec<Dim>::Unit(0);
    walls.back().belt = 0.3 * Vec<Dim>::Unit(0);
    walls.back().uneven = true;

    std::vector<Pair> list;
    std::vector<WallPair> wall_list;
    for (int i = 0; i < count; ++i) {
      for (int j = i + 1; j < count; ++j) {
        if ((grains[static_cast<std::size_t>(i)].position() -
             grains[static_cast<std::size_t>(j)].position())
                .norm() < 2.1) {
          list.push_back({i, j});
        }
      }
      for (int w = 0; w < 2; ++w) wall_list.push_back({i, w});
    }
    const auto remembered = [&](std::size_t size) {
      std::vector<Memory> memories(size);
      if constexpr (Memory::kReals > 0) {
        for (Memory& m : memories) {
          for (int r = 0; r < Memory::kReals; ++r) m[r] = between(-1e-3, 1e-3);
          const auto stiffen = [&](auto& part) {
            if constexpr (std::is_same_v<decltype(part.stiffness), double>) {
              part.stiffness = between(0, 1e4);
            }
          };
          stiffen(m);
          if constexpr (needs.rolling) stiffen(m.sliding);
        }
      }
      return memories;
    };
    const auto memories = remembered(list.size());
    const auto wall_memories = remembered(wall_list.size());
    pairs.assign(std::move(list), memories);
    wall_pairs.assign(std::move(wall_list), wall_memories);
  }

  ContactScene<Dim, Law> scene() {
    // The step is so long that some contacts began within it.
    return {grains.data(), loads.data(), &materials, &laws, walls.data(), 1e-2, 0.01};
  }
  Body<Dim, needs> body(int i) const { return read_bodies<double>(grains.data(), {i}); }
};

template <class Table>
bool same_memories(const Table& a, const Table& b) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!(a.memory(k) == b.memory(k))) return false;
  }
  return true;
}

template <class H>
bool same_loads(const H& a, const H& b) {
  for (std::size_t i = 0; i < a.loads.size(); ++i) {
    if (a.loads[i].at != b.loads[i].at) return false;
  }
  return true;
}

#define KERNEL_CASES                                                               \
  Case<2, LinearSpring>, Case<3, LinearSpring>, Case<2, Hertz>, Case<3, Hertz>,    \
      Case<2, ViscousSpring>, Case<3, ViscousSpring>, Case<2, ViscousHertz>,       \
      Case<3, ViscousHertz>, Case<2, FrictionalSpring>, Case<3, FrictionalSpring>, \
      Case<2, FrictionalHertz>, Case<3, FrictionalHertz>, Case<2, RollingSpring>,  \
      Case<3, RollingSpring>, Case<2, RollingHertz>, Case<3, RollingHertz>

}  // namespace

TEST_SUITE("contact_kernel") {
  TEST_CASE_TEMPLATE("every instruction set gives the bits of the scalar path", C, KERNEL_CASES) {
    constexpr int Dim = C::Dim;
    using Law = typename C::Law;
    for (const auto& kind : {std::pair{1, Listing::tight},
                             {1, Listing::loose},
                             {2, Listing::tight},
                             {2, Listing::loose}}) {
      const int material_count = kind.first;
      const Listing listing = kind.second;
      // Counts that fill the lanes and the stretches that are searched, and counts that do not.
      for (const int count : {2, 6, 9, 30, 61, 250}) {
        CAPTURE(material_count);
        CAPTURE(static_cast<int>(listing));
        CAPTURE(count);
        const auto run = [&](InstructionSet set, Heap<Dim, Law>& heap,
                             std::vector<PairLoad<Dim, Law::needs>>& kept,
                             std::vector<WallLoad<Dim>>& wall_loads) {
          const ContactKernel<Dim, Law> kernel(set, material_count == 1);
          const auto scene = heap.scene();
          wall_loads.assign(2, {});
          kept.resize(heap.pairs.size());
          std::vector<Tally> tallies;
          for (int step = 0; step < 3; ++step) {
            tallies.push_back(kernel.pairs(scene, heap.pairs, listing));
            tallies.push_back(kernel.pairs(scene, heap.pairs, listing, kept.data()));
            tallies.push_back(kernel.walls(scene, heap.wall_pairs, wall_loads.data()));
          }
          return tallies;
        };
        Heap<Dim, Law> reference(count, material_count);
        std::vector<PairLoad<Dim, Law::needs>> reference_kept;
        std::vector<WallLoad<Dim>> reference_walls;
        const auto expected =
            run(InstructionSet::scalar, reference, reference_kept, reference_walls);

        for (const InstructionSet set : instruction_sets()) {
          CAPTURE(static_cast<int>(set));
          Heap<Dim, Law> heap(count, material_count);
          std::vector<PairLoad<Dim, Law::needs>> kept;
          std::vector<WallLoad<Dim>> walls;
          const auto tallies = run(set, heap, kept, walls);

          CHECK(same_loads(heap, reference));
          CHECK(same_memories(heap.pairs, reference.pairs));
          CHECK(same_memories(heap.wall_pairs, reference.wall_pairs));
          for (std::size_t w = 0; w < walls.size(); ++w) {
            CHECK(walls[w].force == reference_walls[w].force);
            CHECK(walls[w].torque == reference_walls[w].torque);
            CHECK(walls[w].power == reference_walls[w].power);
          }
          CHECK(!walls[1].torque.isZero(0));
          for (std::size_t k = 0; k < kept.size(); ++k) {
            CHECK(kept[k].for_i.at == reference_kept[k].for_i.at);
            CHECK(kept[k].for_j.at == reference_kept[k].for_j.at);
          }
          for (std::size_t k = 0; k < tallies.size(); ++k) {
            CHECK(tallies[k].dashpot == expected[k].dashpot);
            CHECK(tallies[k].friction == expected[k].friction);
            CHECK(tallies[k].excess == expected[k].excess);
            CHECK(tallies[k].contacts == expected[k].contacts);
          }
        }
      }
    }
  }

  TEST_CASE_TEMPLATE("a list searched first for what touches gives the bits of the whole list", C,
                     KERNEL_CASES) {
    constexpr int Dim = C::Dim;
    using Law = typename C::Law;
    using Kept = std::vector<PairLoad<Dim, Law::needs>>;
    for (const InstructionSet set : instruction_sets()) {
      CAPTURE(static_cast<int>(set));
      const ContactKernel<Dim, Law> kernel(set, true);
      Heap<Dim, Law> tight(400, 1), loose(400, 1);
      const std::size_t end = tight.pairs.size();
      // What stood there before must go where nothing touches.
      PairLoad<Dim, Law::needs> stale;
      stale.for_i.at.fill(7);
      stale.for_j.at.fill(7);
      Kept kept_tight(end, stale), kept_loose(end, stale);
      REQUIRE(end > 600);  // several stretches

      const Tally a = kernel.pairs(tight.scene(), tight.pairs, Listing::tight);
      const Tally b = kernel.pairs(loose.scene(), loose.pairs, Listing::loose);
      kernel.pairs(tight.scene(), tight.pairs, Listing::tight, kept_tight.data());
      kernel.pairs(loose.scene(), loose.pairs, Listing::loose, kept_loose.data());

      CHECK(a.contacts > 100);
      CHECK(a.contacts < 0.9 * static_cast<double>(end));
      CHECK(b.contacts == a.contacts);
      CHECK(b.excess == a.excess);
      CHECK(relative_error(b.dashpot, a.dashpot) < 1e-12);
      CHECK(relative_error(b.friction, a.friction) < 1e-12);
      CHECK(same_loads(loose, tight));
      CHECK(same_memories(loose.pairs, tight.pairs));
      for (std::size_t k = 0; k < end; ++k) {
        CHECK(kept_loose[k].for_i.at == kept_tight[k].for_i.at);
        CHECK(kept_loose[k].for_j.at == kept_tight[k].for_j.at);
      }
    }
  }

  TEST_CASE_TEMPLATE("the widest path gives what the readable formula gives, contact by contact", C,
                     KERNEL_CASES) {
    constexpr int Dim = C::Dim;
    using Law = typename C::Law;
    using Load = LoadRecord<Dim, Law::needs>;
    for (const int material_count : {1, 2}) {
      CAPTURE(material_count);
      Heap<Dim, Law> heap(61, material_count);
      const Heap<Dim, Law> before = heap;
      std::vector<PairLoad<Dim, Law::needs>> kept(heap.pairs.size());
      const ContactKernel<Dim, Law> kernel(instruction_sets().back(), material_count == 1);

      const Tally tally = kernel.pairs(heap.scene(), heap.pairs, Listing::tight, kept.data());

      double dashpot = 0, friction = 0, deepest = 0;
      int touching_count = 0, rolling_count = 0;
      for (std::size_t k = 0; k < heap.pairs.size(); ++k) {
        const auto [i, j] = before.pairs.pairs()[k];
        const auto a = before.body(i), b = before.body(j);
        const auto [touching, touch] = touch_of(a, b);
        Vec<Dim> force = Vec<Dim>::Zero();
        auto memory = before.pairs.memory(k);
        if (touching) {
          ++touching_count;
          const auto response =
              before.laws.of(before.materials, i, j).respond(touch, memory, heap.scene().time_step);
          force = response.force;
          dashpot += response.dashpot_loss;
          friction += response.friction_loss;
          deepest = std::max(deepest, touch.overlap - 0.01 * std::min(a.radius, b.radius));
          CHECK(heap.pairs.memory(k) == memory);
          if constexpr (Law::needs.spin) {
            const Vec<Dim> arm_i = -(a.radius - 0.5 * touch.overlap) * touch.normal;
            const SpinVec<Dim> turn = torque<double>(arm_i, force) + response.moment;
            SpinVec<Dim> kept_turn;
            for (int d = 0; d < kSpinDim<Dim>; ++d) {
              kept_turn[d] = kept[k].for_i.at[static_cast<std::size_t>(Load::kTorque + d)];
            }
            CHECK((kept_turn - turn).norm() <= 1e-12 * turn.norm());
            if (!response.moment.isZero(0)) ++rolling_count;
          }
        } else {
          CHECK(heap.pairs.memory(k) == decltype(memory){});
        }
        for (int d = 0; d < Dim; ++d) {
          CHECK(kept[k].for_i.at[static_cast<std::size_t>(d)] == force[d]);
          CHECK(kept[k].for_j.at[static_cast<std::size_t>(d)] == force[d]);
        }
      }
      CHECK(touching_count > 20);
      CHECK((rolling_count > 20) == Law::needs.rolling);
      CHECK(touching_count < static_cast<int>(heap.pairs.size()));
      CHECK(relative_error(tally.dashpot, dashpot) < 1e-12);
      CHECK(relative_error(tally.friction, friction) < 1e-12);
      CHECK(tally.excess == deepest);
      CHECK(tally.contacts == touching_count);
    }
  }
}
