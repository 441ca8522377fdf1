// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/files.hpp>
#include <lagrain/scene.hpp>
#include <lagrain/words.hpp>

#include "support/files.hpp"
#include "support/scene_text.hpp"

#include <doctest/doctest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

std::string refusal_of(const std::string& text) {
  return scene_error_of([&] { parse_scene<2>(text, "s.toml"); });
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_SUITE("words") {
  TEST_CASE(
      "what a terminal would obey is shown as an escape, letters of all languages as they are") {
    CHECK(readable("a\x1b[31mred\n\t\x7f") == "a\\u001B[31mred\\n\\t\\u007F");
    CHECK(readable("\xC2\x9B"
                   "31m") == "\\u009B31m");
    CHECK(readable("Körner, 粒, µ") == "Körner, 粒, µ");
    CHECK(readable("\xFF\xC3") == "\\xFF\\xC3");
    CHECK(readable("\xE7\xB2") == "\\xE7\\xB2");
    CHECK(readable("") == "");
  }

  TEST_CASE("long text is cut between letters") {
    CHECK(shortened(std::string(20'000, 'x'), 5) == "xxxxx...");
    CHECK(shortened("粒粒粒", 2) == "粒粒...");
    CHECK(shortened("abc", 3) == "abc");
    CHECK(shown(std::string(20'000, 'x')).size() < 100);
  }

  TEST_CASE("the nearest word is found without regard to capitals, and by a part of it") {
    const std::vector<std::string> words{"velocity Verlet", "symplectic Euler", "fourth order"};
    CHECK(nearest_word("verlet", words) == "velocity Verlet");
    CHECK(nearest_word("Fourth Order", words) == "fourth order");
    CHECK(nearest_word("leapfrog", words).empty());
    CHECK(nearest_word("", words).empty());
    CHECK(nearest_word(std::string(20'000, 'x'), words).empty());
  }

  TEST_CASE("a limit is rounded down, or who keeps to it would be refused again") {
    CHECK(rounded_down(2.3508280656458366e-05) == "2.35e-05");
    CHECK(rounded_down(2.3591e-05) == "2.35e-05");
    CHECK(rounded_down(0.9996) == "0.999");
    for (double value = 1e-9; value < 1e9; value *= 1.37) {
      const double shown = std::strtod(rounded_down(value).c_str(), nullptr);
      CHECK(shown <= value);
      CHECK(shown > 0.98 * value);
    }
  }

  TEST_CASE("no sentence about a scene holds control characters, or long names whole") {
    const std::string red = "\\u001b[31m", thousands(20'000, 'x');
    for (const std::string& text :
         {with(kHeap, "\"gravel\"", "\"" + red + "\""),
          with(kHeap, "\"gravel\"", "\"" + thousands + "\""),
          with(kHeap, "\"linear\"", "\"" + red + "\""),
          with(kHeap, "\"8 mm\"", "\"8 " + red + "\""),
          with(kHeap, "\"8 mm\"", "\"" + thousands + "\""),
          with(kHeap, "\"floor\"", "\"" + red + "\""),
          with(kHeap, "\"floor\"", "\"" + thousands + "\""),
          with(kHeap, "materials.gravel", "materials.\"" + red + "\""),
          with(kHeap, "materials.gravel", "materials." + thousands),
          with(kHeap, "seed = 5", "\"" + red + "\" = 5"),
          with(kHeap, "seed = 5", thousands + " = 5"),
          with(kHeap, "seed = 5", "seed = " + thousands),
          with(kHeap, "seed = 5", "seed = [" + std::string(20'000, '[')),
          with(kHeap, "seed = 5", "law = 1\n" + thousands + ".seed = 5"),
          with(kHeap, "[0, -9.81]", "[\"" + red + "\", \"" + thousands + "\"]")}) {
      const std::string message = refusal_of(text);
      CAPTURE(message);
      CHECK(message != "accepted");
      CHECK(readable(message) == message);
      CHECK(message.size() < 600);
    }
  }

  TEST_CASE("a word of other programs, or with a capital, has a nearest one") {
    CHECK(holds(refusal_of(with(kHeap, "\"elastic\"", "\"coulomb\"")),
                "got \"coulomb\" (did you mean \"elastic\"?)"));
    CHECK(holds(refusal_of(with(kHeap, "\"elastic\"", "\"Elastic\"")),
                "(did you mean \"elastic\"?)"));
    CHECK(holds(refusal_of(with(kHeap, "count = 12", "count = 12\narrangement = \"Random\"")),
                "(did you mean \"random\"?)"));
    CHECK(
        holds(refusal_of(with(kHeap, "\"linear\"", "\"Hookean\"")), "(did you mean \"linear\"?)"));
    CHECK(!holds(refusal_of(with(kHeap, "\"linear\"", "\"quantum\"")), "did you mean"));
  }

  TEST_CASE("a quantity in quotes without a unit says that the unit is missing") {
    CHECK(refusal_of(with(kHeap, "radius = \"20 mm\"", "radius = \"20\"")) ==
          "s.toml:26: grain[0].radius: expected a positive length [m], got \"20\", which has no "
          "unit (a number without quotes is in m)");
    CHECK(!holds(refusal_of(with(kHeap, "radius = \"20 mm\"", "radius = \"20 kg\"")), "no unit"));
  }

  TEST_CASE("what stands twice, or without its heading, is told in words") {
    const std::string headless = refusal_of(without(kHeap, "[law]"));
    CHECK(holds(headless,
                "\"friction\" stands here a second time (or does a heading such as [law] "
                "miss above this line?)"));
    CHECK(holds(refusal_of(kHeap + "[law]\n"),
                "\"law\" stands here a second time; a table has one heading"));
    CHECK(holds(refusal_of(kHeap + "[fill]\n"), "a list of tables is headed [[fill]] each time"));
    CHECK(holds(refusal_of(kHeap + "[[law]]\n"), "as something else"));
    CHECK(holds(refusal_of("title = \"x"), "the file ends within a string"));
    CHECK(!holds(refusal_of("title = \"x"), "Error while"));
    std::string deep = "a";
    for (int k = 0; k < 100'000; ++k) deep += ".a";
    CHECK(holds(refusal_of(deep + " = 1"), "a key of more than 1000 parts"));
  }

  TEST_CASE("a file that cannot be read says why") {
    const Folder folder;
    std::filesystem::create_directories(folder.path);
    CHECK(why_unreadable(folder.path / "none") == "does not exist");
    CHECK(why_unreadable(folder.path / "none" / "below") == "does not exist");
    CHECK(why_unreadable(folder.path) == "is a folder, no file");
    write_file(folder.path / "file", "x");
    CHECK(why_unreadable(folder.path / "file").empty());
    CHECK(why_unreadable(folder.path / "file" / "below") == "cannot be read: Not a directory");
    CHECK(why_unreadable(folder.path / std::string(5000, 'a')) ==
          "cannot be read: File name too long");
    if (::geteuid() != 0) {
      std::filesystem::permissions(folder.path / "file", std::filesystem::perms::none);
      CHECK(why_unreadable(folder.path / "file") == "cannot be read: Permission denied");
    }
  }
}
