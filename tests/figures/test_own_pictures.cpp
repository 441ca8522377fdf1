// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of a run: which states its folder gives, and what is on the page.

#include "own_picture.hpp"

#include <lagrain/output.hpp>

#include "support/files.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <variant>

using namespace lagrain;
using namespace lagrain::figures;
using lagrain::test::Folder;

namespace {

namespace fs = std::filesystem;

const std::string kPressed = R"(dimension = 2
duration = "0.1 s"
gravity = [0, -9.81]
normal = "linear"
friction = "elastic"
law = { stiffness = "1e5 N/m", restitution = 0.5, friction = 0.4 }
materials = { glass = { density = 2500 } }
fill = [{ count = 30, radius = "10 mm", region = { low = [0, 0], high = [0.2, 0.3] } }]
box = [{ low = [0, 0], high = [0.2, 0.3], open = ["top"] }]
[[wall]]
name = "lid $x$"
point = [0, 0.3]
normal = [0, -1]
motion = { type = "piston", mass = 20, load = [0, -400] }
[output]
frames_every = "20 ms"
)";

std::unique_ptr<Run<2>> recorded(const fs::path& folder, const std::string& text = kPressed) {
  auto run = make_run(parse_scene<2>(text, "scene.toml"), 1);
  record(*run, {folder, {}, {}});
  return run;
}

template <class Kind>
std::ptrdiff_t count(const DisplayList& list) {
  return std::count_if(list.items.begin(), list.items.end(),
                       [](const Item& item) { return std::holds_alternative<Kind>(item); });
}

bool says(const DisplayList& list, const std::string& text) {
  return std::any_of(list.items.begin(), list.items.end(), [&](const Item& item) {
    const auto* label = std::get_if<Label>(&item);
    return label != nullptr && label->text.find(text) != std::string::npos;
  });
}

DisplayList page(const RunFolder<2>& folder, const Snapshot<2>& snapshot, const PictureWish& wish) {
  return picture_of(folder.scene(), snapshot, wish, scale_of(folder.scene(), snapshot, wish)).list;
}

std::string complaint(const auto& what) {
  try {
    what();
  } catch (const SceneError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_SUITE("own pictures") {
  TEST_CASE("a frame is read back bit for bit, and pistons stand where they then were") {
    const Folder place;
    const auto run = recorded(place.path);
    const RunFolder<2> folder(place.path);
    REQUIRE(folder.frames() == 6);

    const Snapshot<2> last = folder.nearest({}, {});
    CHECK(last.source == "frame 5");
    CHECK(last.frame.position == run->positions());
    CHECK(last.frame.velocity == run->velocities());
    CHECK(*last.frame.spin == *run->spins());
    CHECK(last.walls.front().point == run->walls().front().point);
    CHECK(folder.nearest(0.041, {}).source == "frame 2");

    // In between the series tells, to a row of it.
    const auto again = make_run(parse_scene<2>(kPressed, "scene.toml"), 1);
    again->advance_to(folder.time_of(3));
    const Vec<2> there = again->walls().front().point;
    CHECK((folder.at(3, {}).walls.front().point - there).norm() < 1e-6);
    CHECK((there - again->scene().walls.front().point).norm() > 1e-3);
  }

  TEST_CASE("grains, walls, time, length and colours are on the page, forces if asked for") {
    const Folder place;
    const auto run = recorded(place.path);
    const RunFolder<2> folder(place.path);
    const Snapshot<2> last = folder.nearest({}, {.contacts = true, .groups = true});
    CHECK(last.source == "the checkpoint");
    REQUIRE(last.contacts);
    CHECK(last.contacts->size() == run->contacts().size());
    CHECK(last.group.front() == "fill 1");

    const DisplayList plain = page(folder, last, {.colour = ColourBy::speed});
    CHECK(count<Disc>(plain) == run->count());
    CHECK(count<Polyline>(plain) == 4);  // the walls
    CHECK(says(plain, "$t$ = 0.100 s"));
    CHECK(says(plain, "cm"));
    CHECK(says(plain, "speed"));

    const DisplayList chains = page(folder, last, {.forces = true});
    CHECK(count<Segment>(chains) ==
          static_cast<std::ptrdiff_t>(last.contacts->size()) + 3 + 3);  // length bar, legend
    CHECK(says(chains, " N"));
    const DisplayList geometry = page(folder, last, {.cells = true, .edges = true, .skins = true});
    CHECK(count<Polygon>(geometry) >= 2 * run->count());
    CHECK(count<Disc>(geometry) == 2 * run->count());

    const PicturePage sized = picture_of(folder.scene(), last, {.size = std::array{800, 600}},
                                         scale_of(folder.scene(), last, {}));
    CHECK(std::abs(sized.list.width * sized.dpi / 72 - 800) < 1e-6);
    CHECK(std::abs(sized.list.height * sized.dpi / 72 - 600) < 1e-6);
  }

  TEST_CASE("forces of frames are there if the scene kept them, else it is said how to") {
    const Folder place, kept;
    recorded(place.path);
    const RunFolder<2> without(place.path);
    CHECK(complaint([&] { without.at(1, {.contacts = true}); }).find("contacts = true") !=
          std::string::npos);

    std::string text = kPressed;
    text.replace(text.find("frames_every"), 0, "contacts = true\n");
    const auto run = recorded(kept.path, text);
    const Snapshot<2> last = RunFolder<2>(kept.path).at(5, {.contacts = true});
    const auto exact = run->contacts();
    REQUIRE(last.contacts->size() == exact.size());
    for (std::size_t k = 0; k < exact.size(); ++k) {
      CHECK((*last.contacts)[k].i == exact[k].i);
      CHECK((*last.contacts)[k].j == exact[k].j);
      CHECK((*last.contacts)[k].wall == exact[k].wall);
      CHECK((*last.contacts)[k].force == exact[k].force);
    }
  }

  TEST_CASE("a series whose last row is not ended is plotted without it") {
    const Folder place;
    recorded(place.path);
    const fs::path series = place.path / "series.csv";
    const DisplayList whole = plot_of_series(series, {"kinetic", "lid $x$.fy"}).list;
    std::ofstream(series, std::ios::app) << "0.2,17";
    CHECK(plot_of_series(series, {"kinetic", "lid $x$.fy"}).list.items.size() ==
          whole.items.size());
    CHECK(says(whole, "lid \\$x\\$.fy [N]"));
    CHECK(says(whole, "time [s]"));
    const std::string near = complaint([&] { plot_of_series(series, {"kinetik"}); });
    CHECK(near.find("did you mean \"kinetic\"?") != std::string::npos);
  }

  TEST_CASE("what cannot be drawn is said in a sentence") {
    const Folder place;
    CHECK(complaint([&] { dimension_of_run(place.path); }).find("no folder") != std::string::npos);
    fs::create_directories(place.path);
    CHECK(complaint([&] { dimension_of_run(place.path); }).find("no scene.toml") !=
          std::string::npos);
    CHECK(complaint([&] { write_page({}, place.path / "a.gif"); }).find(".png, .pdf or .svg") !=
          std::string::npos);
    std::ofstream(place.path / "scene.toml") << kPressed;
    const RunFolder<2> empty(place.path);
    CHECK(complaint([&] { empty.nearest({}, {}); }).find("no state") != std::string::npos);
    CHECK(label_text("50 $ \\ \xE7\xA0\x82") == "50 \\$ \\\\ ?");
  }
}
