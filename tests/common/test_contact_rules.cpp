// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/contact_rules.hpp>

#include <lagrain/audit.hpp>
#include <lagrain/observe.hpp>

#include "support/scenes.hpp"
#include "support/space.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim>
Grain<Dim> ball(const Vec<Dim>& place, const Vec<Dim>& velocity, int material) {
  Grain<Dim> g;
  g.radius = 0.5;
  g.mass = 1;
  g.position = place;
  g.velocity = velocity;
  g.material = material;
  return g;
}

}  // namespace

TEST_SUITE("contact rules") {
  TEST_CASE("a table keeps the pairs of materials that do not touch, in both orders") {
    LawTable<int> laws(7, 3);
    CHECK(laws.apart().empty());
    laws.set_apart(2, 0);
    CHECK(laws.apart()(0, 2));
    CHECK(laws.apart()(2, 0));
    CHECK(!laws.apart()(2, 2));
    CHECK(laws.between(0, 2) == 7);
    LawTable<int> one(7);
    one.set_apart(0, 0);
    CHECK(one.apart()(0, 0));
    CHECK(one.apart()(3, 200));
  }

  TEST_CASE("rules know pinned grains, materials and walls") {
    MaterialsApart apart;
    apart.add(0, 1);
    const std::vector<std::uint8_t> material{0, 1, 1, 0};
    const ContactRules rules(PinnedGrains(4, [](int i) { return i < 3 ? 1.0 : 0.0; }), material,
                             apart);
    std::vector<Pair> pairs{{0, 1}, {0, 3}, {1, 2}, {1, 3}};
    rules.drop_from(pairs);
    CHECK(pairs == std::vector<Pair>{{0, 3}, {1, 2}});
    auto wall = Wall<2>::half_space("w", {0, 0}, {0, 1});
    wall.material = 1;
    CHECK(!rules.may_touch(0, wall));
    CHECK(rules.may_touch(1, wall));
    CHECK(!rules.may_touch(3, wall));  // pinned, and apart
    const ContactRules all(PinnedGrains(), material, {});
    CHECK(all.may_touch({0, 1}));
    CHECK(ContactRules().may_touch(5, wall));
  }

  TEST_CASE_TEMPLATE("grains of materials set apart go through each other and through walls", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    LawTable<LinearSpring> laws(LinearSpring::with_restitution(1e4, 0.5), 3);
    laws.set_apart(0, 1);
    laws.set_apart(1, 2);
    auto floor = Wall<Dim>::half_space("floor", -2 * up<Dim>(), up<Dim>());
    auto lid = flat_piece<Dim>("lid", -2 * up<Dim>() - 5 * along<Dim>(),
                               -2 * up<Dim>() + 5 * along<Dim>());
    floor.material = lid.material = 2;
    const Vec<Dim> down = -3 * up<Dim>();
    // Two meet on a line, one of them starts within the other.
    const std::vector<Grain<Dim>> list{ball<Dim>(0.3 * along<Dim>(), Vec<Dim>::Zero(), 0),
                                       ball<Dim>(0.1 * up<Dim>(), down, 1)};
    Setting<Dim> setting;
    setting.time_step = 1e-4;
    setting.largest_overlap = 0.3;
    Simulation<Dim, LinearSpring, VelocityVerlet, AllPairs<Dim>> sim(
        make_grains<Dim, Needs{}>(list), laws, {floor, lid}, setting);
    sim.step(30000);
    CHECK(sim.grains().position.col(0) == list[0].position);
    CHECK((sim.grains().position.col(1) - list[1].position - 3 * down).norm() < 1e-9);
    CHECK(sim.near_pairs().empty());
    CHECK(contact_statistics(sim).wall_contacts == 0);
    CHECK(energy_ledger(sim).elastic == 0);
  }

  TEST_CASE_TEMPLATE("the audit finds a contact with a wall that is not listed", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const auto floor = Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up<Dim>());
    const auto plate = flat_piece<Dim>("plate", -along<Dim>(), along<Dim>());
    const std::vector<Wall<Dim>> walls{floor, plate};
    Columns<Dim> x(Dim, 2);
    x.col(0) = 0.4 * up<Dim>();
    x.col(1) = 9 * up<Dim>();
    const Eigen::VectorXd radius = Eigen::VectorXd::Constant(2, 0.5);
    ContactAudit<Dim> audit;
    audit.check_walls(x, radius, walls, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}});
    CHECK(audit.contacts() == 2);
    CHECK(audit.missed() == 0);
    audit.check_walls(x, radius, walls, {{0, 0, 0}, {1, 1, 0}});
    CHECK(audit.missed() == 1);
    // Who may not touch is not missed.
    const ContactRules pinned(PinnedGrains(2, [](int) { return 0.0; }));
    audit.check_walls(x, radius, walls, {}, pinned);
    CHECK(audit.missed() == 1);
  }
}
