// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/format.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/run.hpp>
#include <lagrain/scene.hpp>

#include "support/files.hpp"
#include "support/scene_text.hpp"
#include "support/tolerance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// Discs fall from an inlet through an hour-glass into an outlet. Some jump over its rim, and leave
/// the domain.
const std::string kHourGlass = R"(dimension = 2
duration = 2
gravity = [0, -9.81]
normal = "linear"
friction = "elastic"
audit = true
[law]
stiffness = 1e6
restitution = 0.5
friction = 0.4
[materials.glass]
density = 2500
[[inlet]]
name = "hopper"
radius = { uniform = [0.008, 0.01] }
region = { low = [-0.25, 0.6], high = [0.25, 0.9] }
rate = 200
start = 0.1
stop = 1.1
velocity = [0, -1]
[[outlet]]
name = "sink"
low = [-0.1, -0.3]
high = [0.1, -0.1]
[domain]
low = [-0.4, -0.5]
high = [0.4, 1]
[[wall]]
name = "left slope"
from = [-0.2, 0.5]
to = [-0.05, 0.2]
[[wall]]
name = "right slope"
from = [0.2, 0.5]
to = [0.05, 0.2]
)";

/// Spheres fall at a rate into a box with an open bottom; line 23 is the first line of the inlet.
const std::string kFall = R"(dimension = 3
duration = 1
gravity = [0, 0, -9.81]
normal = "hertz"
friction = "viscous"
[law]
modulus = 1e7
impact_speed = 3
restitution = 0.7
friction = 0.3
[materials.glass]
density = 2500
[materials.lead]
density = 11000
[[grain]]
position = [0, 0, 0.5]
radius = 0.02
material = "lead"
[[box]]
material = "glass"
low = [-0.1, -0.1, 0]
high = [0.1, 0.1, 1]
open = ["bottom"]
[[inlet]]
name = "rain"
material = "glass"
radius = 0.01
region = { low = [-0.1, -0.1, 0.7], high = [0.1, 0.1, 0.9] }
rate = 100
[[outlet]]
low = [-1, -1, -1]
high = [1, 1, -0.5]
)";

template <int Dim>
std::string message_of(const std::string& text) {
  return scene_error_of([&] { parse_scene<Dim>(text, "s.toml"); });
}
std::string message_with(const std::string& part, const std::string& instead) {
  return message_of<3>(with(kFall, part, instead));
}

std::string fact_of(const Run<2>& run, const std::string& name) {
  for (const auto& [key, value] : facts(run)) {
    if (key == name) return value;
  }
  return "none";
}

std::int64_t came(const TrafficCounts& traffic) {
  std::int64_t sum = 0;
  for (const auto& in : traffic.inlets) sum += in.grains;
  return sum;
}
std::int64_t went(const TrafficCounts& traffic) {
  std::int64_t sum = traffic.lost;
  for (const auto& out : traffic.outlets) sum += out.grains;
  return sum;
}

}  // namespace

TEST_SUITE("grains that come and leave, in scenes") {
  TEST_CASE("inlets, outlets and a domain survive being written, bit for bit") {
    std::string text = with(kHourGlass, "velocity = [0, -1]", "velocity = { random = 0.1 }");
    text = with(text, "stop = 1.1", "stop = 1.1\ncount = 70");
    const Scene<2> scene = parse_scene<2>(text, "s.toml");
    const Scene<2> again = parse_scene<2>(to_toml(scene), "again.toml");
    CHECK(to_toml(again) == to_toml(scene));
    const Inlet<2>& inlet = again.inlets.at(0);
    CHECK(inlet.name == "hopper");
    CHECK(inlet.rate == 200);
    CHECK((inlet.start == 0.1 && inlet.stop == 1.1));
    CHECK(inlet.count == 70);
    CHECK(inlet.random_speed == 0.1);
    CHECK(inlet.region.low == Vec<2>(-0.25, 0.6));
    CHECK(again.outlets.at(0).region.high == Vec<2>(0.1, -0.1));
    CHECK(again.domain->low == Vec<2>(-0.4, -0.5));
    const Scene<3> fall = parse_scene<3>(to_toml(parse_scene<3>(kFall, "s")), "again");
    CHECK(std::isinf(fall.inlets.at(0).stop));
    CHECK(!fall.inlets.at(0).count);
    CHECK(fall.outlets.at(0).name == "outlet 1");
    CHECK(!fall.domain);
  }

  TEST_CASE("what cannot work is refused in one sentence") {
    CHECK(message_with("rate = 100", "rate = 0") ==
          "s.toml:29: inlet[0].rate: expected a positive rate [1/s], got 0");
    CHECK(message_with("rate = 100\n", "") ==
          "s.toml:24: inlet[0].rate: missing; expected a positive rate [1/s]");
    CHECK(message_with("rate = 100", "rate = 100\nstart = 2\nstop = 1") ==
          "s.toml:31: inlet[0].stop: expected a time after start");
    CHECK(message_with("radius = 0.01", "radius = { uniform = [0.01, 0.11] }") ==
          "s.toml:28: inlet[0].region: is 0.2 m wide, too narrow for grains 0.22 m wide");
    CHECK(message_with("rate = 100", "rate = 100\n[[inlet]]\nname = \"rain\"") ==
          "s.toml:31: inlet[1].name: a second \"rain\"");
    CHECK(message_with("[[outlet]]", "[[outlet]]\nname = \"rain\"") ==
          "s.toml:31: outlet[0].name: a second \"rain\"");
    CHECK(message_with("low = [-1, -1, -1]\nhigh = [1, 1, -0.5]",
                       "low = [0.05, -1, -1]\nhigh = [1, 1, 0.8]") ==
          "s.toml:31: outlet[0].low: reaches into inlet \"rain\": its grains would leave");
    CHECK(message_with("high = [1, 1, -0.5]", "high = [1, 1, -2]") ==
          "s.toml:32: outlet[0].high: expected low below high in every direction");
    const std::string domain = "[domain]\nlow = [-1, -1, -0.9]\nhigh = [1, 1, 0.8]\n[[outlet]]";
    CHECK(message_with("[[outlet]]", domain) == "s.toml:30: domain: does not hold inlet \"rain\"");
    CHECK(message_with("[[outlet]]", with(with(domain, "0.8", "2"), "-0.9", "-0.4")) ==
          "s.toml:30: domain: ends before outlet \"outlet 1\", which no grain reaches");
    CHECK(message_with("[[outlet]]", with(domain, "0.8", "2")) == "accepted");

    std::string smooth = with(kFall, "\"viscous\"", "\"none\"\nintegrator = \"fourth order\"");
    smooth = with(with(smooth, "restitution = 0.7", "restitution = 1"), "friction = 0.3\n", "");
    CHECK(
        message_of<3>(smooth) ==
        "s.toml:6: integrator: \"fourth order\" is for grains that stay and keep their energy, but "
        "here grains come in; choose another one");
    const auto unknown = message_with("rate = 100", "rate = 100\nrates = 5");
    CHECK(unknown.find("did you mean \"rate\"?") != std::string::npos);
  }

  TEST_CASE("grains outside of the domain at the start are refused by number") {
    const auto domain = "[domain]\nlow = [-1, -1, -1]\nhigh = [1, 1, 1]\n[[outlet]]";
    std::string text = with(with(kFall, "[[outlet]]", domain), "[0, 0, 0.5]", "[0, 0, -1.5]");
    CHECK(scene_error_of([&] { make_run(parse_scene<3>(text, "s.toml")); }) ==
          "s.toml:30: domain: grain 0 lies outside of it at the start");
  }

  TEST_CASE("so many come as the rate says, from start to stop") {
    auto run = make_run(parse_scene<2>(kHourGlass, "s.toml"));
    const double look = 100 * run->time_step();
    for (const double t : {0.05, 0.2, 0.5, 1.0, 1.5}) {
      run->advance_to(t);
      const double asked = 200 * std::clamp(t - 0.1, 0.0, 1.0);
      const auto& in = run->traffic()->inlets[0];
      CHECK(std::abs(static_cast<double>(in.grains) - asked) <= 200 * look + 1);
      CHECK(in.waiting == 0);
      CHECK(in.longest_wait < look);
    }
    CHECK(run->traffic()->inlets[0].grains == 200);
    const auto counted = with(kHourGlass, "stop = 1.1", "count = 30");
    auto few = make_run(parse_scene<2>(counted, "s.toml"));
    few->advance_to(1);
    CHECK(few->traffic()->inlets[0].grains == 30);
  }

  TEST_CASE("an hour-glass loses no grain unnamed, and its ledger closes") {
    auto run = make_run(parse_scene<2>(kHourGlass, "s.toml"));
    CHECK(run->count() == 0);
    double largest = 0, turned_over = 0;
    while (!run->finished()) {
      run->step(500);
      const auto& traffic = *run->traffic();
      REQUIRE(came(traffic) == run->count() + went(traffic));
      REQUIRE(run->groups() == std::vector<int>(static_cast<std::size_t>(run->count()), 0));
      REQUIRE(std::is_sorted(run->ids().begin(), run->ids().end()));
      const Ledger now = run->ledger();
      largest = std::max(largest, std::abs(run->energy_residual()));
      turned_over = std::max(turned_over, std::abs(now.carried));
    }
    const auto& traffic = *run->traffic();
    CHECK(traffic.outlets[0].grains > 100);
    CHECK(relative_error(traffic.outlets[0].mass / static_cast<double>(traffic.outlets[0].grains),
                         2500 * 3.1416 * 0.009 * 0.009) < 0.05);
    CHECK(turned_over > 100);
    CHECK(largest < 1e-3 * turned_over);
    CHECK(run->audit().missed() == 0);
    CHECK(run->audit().contacts() > 0);
    CHECK(fact_of(*run, "outlet") == "\"sink\": " + std::to_string(traffic.outlets[0].grains) +
                                         " grains left, " + rounded(traffic.outlets[0].mass) +
                                         " kg");
  }

  TEST_CASE("the same grains come and leave with every neighbourhood, and for all threads") {
    const auto text = without(kHourGlass, "audit = true");
    const auto end_of = [](const std::string& scene, int threads) {
      auto run = make_run(parse_scene<2>(scene, "s.toml"), threads);
      run->advance_to(1.5);
      return frame_csv(*run) + contacts_csv(*run);
    };
    const std::string reference = end_of(text, 1);
    CHECK(std::count(reference.begin(), reference.end(), '\n') > 10);
    CHECK(end_of(text, 3) == reference);
    for (const std::string other : {"linked cells", "all pairs"}) {
      CHECK(end_of("neighbourhood = \"" + other + "\"\n" + text, 1) == reference);
    }
    CHECK(end_of("seed = 2\n" + text, 1) != reference);
  }

  TEST_CASE("spheres of two materials come and leave in space") {
    auto run = make_run(parse_scene<3>(kFall, "s.toml"));
    const double mass = run->masses()[0];
    run->advance_to(1);
    const auto& traffic = *run->traffic();
    CHECK(came(traffic) + 1 == run->count() + went(traffic));
    CHECK(traffic.outlets[0].grains > 20);
    CHECK(traffic.outlets[0].mass > mass);  // the heavy one fell first
    CHECK(run->ids().front() > 0);
    CHECK(std::all_of(run->materials().begin(), run->materials().end(),
                      [](int material) { return material == 0; }));
    CHECK(std::abs(run->energy_residual()) < 1e-3 * std::abs(run->ledger().carried));
  }

  TEST_CASE("grains wait for room, and the delay is told") {
    // The floor is so near that a grain leaves the region only when it is pushed out.
    std::string text = without(kHourGlass, "audit = true");
    text = with(text, "region = { low = [-0.25, 0.6], high = [0.25, 0.9] }",
                "region = { low = [-0.02, 0], high = [0.02, 0.03] }");
    text =
        with(text, "low = [-0.1, -0.3]\nhigh = [0.1, -0.1]", "low = [0.3, -0.3]\nhigh = [0.4, 0]");
    text += "[[wall]]\nname = \"floor\"\npoint = [0, 0]\nnormal = [0, 1]\n";
    auto run = make_run(parse_scene<2>(text, "s.toml"));
    run->advance_to(0.6);
    const auto& in = run->traffic()->inlets[0];
    CHECK(in.waiting > 50);
    CHECK(in.grains > 1);
    CHECK(in.longest_wait > 0.3);
    CHECK(fact_of(*run, "inlet").find(" wait for room, the longest wait was ") !=
          std::string::npos);
    CHECK(run->statistics().largest_overlap < 0.1);
  }

  TEST_CASE("who leaves the domain is taken out and named, with its time") {
    std::string text = with(kHourGlass, "low = [-0.1, -0.3]", "low = [0.38, -0.3]");
    text = with(without(text, "audit = true"), "high = [0.1, -0.1]", "high = [0.39, -0.1]");
    auto run = make_run(parse_scene<2>(text, "s.toml"));
    while (!run->finished()) run->step(1000);
    const auto& traffic = *run->traffic();
    CHECK(traffic.lost > 100);
    CHECK(traffic.first_lost.size() == TrafficCounts::kNamed);
    CHECK(traffic.lost + run->count() == 200);
    const auto fact = fact_of(*run, "left the domain");
    CHECK(fact.find(std::to_string(traffic.lost) +
                    " grains: " + std::to_string(traffic.first_lost[0].id) + " at 0.") == 0);
    CHECK(fact.substr(fact.size() - 5) == ", ...");
  }

  TEST_CASE("the time step is safe for grains that come") {
    const auto dust = with(kFall, "radius = 0.01\n", "radius = { uniform = [0.001, 0.01] }\n");
    const auto placed = with(kFall, "[[box]]",
                             "[[grain]]\nposition = [0, 0, 0.2]\nradius = 0.001\n"
                             "material = \"glass\"\n[[box]]");
    const auto shortest_contact = [](const std::string& text) {
      return make_run(parse_scene<3>(text, "s.toml"))->time_scales().contact;
    };
    CHECK(shortest_contact(dust) == shortest_contact(placed));
    CHECK(shortest_contact(dust) < 0.2 * shortest_contact(kFall));
  }

  TEST_CASE("pinned grains stay, wherever they are") {
    const auto base = "[[grain]]\nposition = [0, -0.2]\nradius = 0.02\npinned = true\n[domain]";
    auto run = make_run(parse_scene<2>(with(kHourGlass, "[domain]", base), "s.toml"));
    run->advance_to(1);
    CHECK(run->id(0) == 0);
    CHECK(run->pinned()[0]);
    CHECK(!run->pinned()[run->count() - 1]);
    CHECK(run->groups()[0] == -1);
    CHECK(run->audit().missed() == 0);
  }

  TEST_CASE("frames name the grains that are there, and the series counts them") {
    const Folder folder;
    auto run = make_run(parse_scene<2>(with(kHourGlass, "duration = 2", "duration = 0.8"), "s"));
    REQUIRE(record(*run, {folder.path, {}, {}}));
    const std::string series = content(folder.path / "series.csv");
    const std::string head = series.substr(0, series.find('\n'));
    CHECK(head.find("refreshes[-],carried[J],grains[-],hopper.in[-],sink.out[-],sink.mass[kg],"
                    "domain.out[-],left slope.fx[N]") != std::string::npos);
    CHECK(content(folder.path / "frames/0001.csv") == frame_csv(*run));
    CHECK(frame_csv(*run).find("\n" + std::to_string(run->ids().back()) + ",") !=
          std::string::npos);
    CHECK(run->ids().front() > 0);
    const std::string first = content(folder.path / "frames/0000.csv");
    CHECK(std::count(first.begin(), first.end(), '\n') == 1);  // nobody is there yet
    const std::string summary = content(folder.path / "summary.txt");
    CHECK(summary.find("\nleft the domain") != std::string::npos);
    CHECK(summary.find("\nenergy carried") != std::string::npos);
    const auto still = make_run(parse_scene<2>(kHeap, "heap"));
    CHECK(still->traffic() == nullptr);
    CHECK(still->ids().empty());
  }

  TEST_CASE("--explain tells of inlets and outlets") {
    const auto run = make_run(parse_scene<2>(kHourGlass, "s.toml"));
    const std::string text = explain(*run);
    CHECK(text.find("inlet           \"hopper\", 200 grains a second, 200 in all") !=
          std::string::npos);
    CHECK(text.find("outlet          \"sink\"") != std::string::npos);
  }
}
