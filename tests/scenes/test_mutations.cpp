// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Everything that reads files is given files that somebody has spoilt: it reads them, or refuses
/// them in one sentence. LAGRAIN_MUTATIONS says how many of each kind (default 400).

#include <lagrain/checkpoint.hpp>
#include <lagrain/files.hpp>
#include <lagrain/output.hpp>
#include <lagrain/placement.hpp>
#include <lagrain/words.hpp>

#include "support/files.hpp"
#include "support/scene_text.hpp"

#include <doctest/doctest.h>

#include <sys/resource.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

namespace fs = std::filesystem;

int mutations() {
  const char* const wished = std::getenv("LAGRAIN_MUTATIONS");
  return wished != nullptr ? std::atoi(wished) : 400;
}

/// Spoils texts and bytes as editors, disks and people do.
class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string operator()(std::string text) {
    for (std::size_t times = 1 + below(4); times > 0; --times) spoil(text);
    return text;
  }
  std::size_t below(std::size_t end) { return end == 0 ? 0 : random_() % end; }

 private:
  void spoil(std::string& text) {
    static constexpr std::array kPieces{"\"",
                                        "'",
                                        "[",
                                        "]",
                                        "[[",
                                        "]]",
                                        "{",
                                        "}",
                                        "=",
                                        ".",
                                        ",",
                                        "\n",
                                        "#",
                                        "-",
                                        "e999",
                                        "nan",
                                        "inf",
                                        "-0",
                                        "1e-320",
                                        "1e308",
                                        "9223372036854775807",
                                        "99999999999999999999",
                                        "true",
                                        "\"\"",
                                        "\"1/0 contact\"",
                                        "\" mm\"",
                                        "\"1e400 m\"",
                                        "\"5 m^9*m^9\"",
                                        "1979-05-27",
                                        "\x1b[31m",
                                        "\xff",
                                        "\xEF\xBB\xBF",
                                        "\\u0000",
                                        "material",
                                        "radius",
                                        "facet normal",
                                        "vertex",
                                        ",,,,"};
    const std::size_t at = below(text.size() + 1);
    switch (below(8)) {
      case 0:  // a bit flips
        if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        return;
      case 1:  // a part is lost
        text.erase(at, 1 + below(40));
        return;
      case 2:  // the end is lost
        text.resize(at);
        return;
      case 3:  // a part stands twice
        text.insert(at, text.substr(below(text.size()), below(200)));
        return;
      case 4: {  // a line is lost or moves
        const std::size_t begin = text.rfind('\n', at) + 1;
        const std::string line = text.substr(begin, text.find('\n', begin) - begin + 1);
        text.erase(begin, line.size());
        if (below(2) == 0) text.insert(text.rfind('\n', below(text.size())) + 1, line);
        return;
      }
      case 5: {  // a number becomes another one
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit == std::string::npos) return;
        const std::size_t end =
            std::min(text.find_first_not_of("0123456789.e", digit), text.size());
        text.replace(digit, end - digit, kPieces[13 + below(10)]);
        return;
      }
      case 6:  // a byte becomes any other
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        return;
      default:  // something slips in
        text.insert(at, kPieces[below(kPieces.size())]);
    }
  }

  std::mt19937 random_;
};

/// Reads many spoilt copies of texts.
/// @param read  throws nothing but SceneError, of one line
void check_spoilt(const std::vector<std::string>& texts,
                  const std::function<void(const std::string&)>& read) {
  Mutator spoilt(7);
  int refused = 0;
  for (int k = 0; k < mutations(); ++k) {
    const std::string text = spoilt(texts[spoilt.below(texts.size())]);
    INFO("mutation " << k << ": " << shortened(text, 4000));
    std::string message;
    try {
      read(text);
    } catch (const SceneError& error) {
      message = error.what();
      ++refused;
    } catch (const std::exception& error) {
      FAIL_CHECK("another exception: " << error.what());
    }
    CHECK(message.find('\n') == std::string::npos);
    CHECK(message.size() < 1500);
  }
  CHECK(refused > mutations() / 10);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  CHECK(usage.ru_maxrss < 4'000'000);  // [KiB], sanitizers included
}

template <int Dim>
void read_text(const std::string& text) {
  const Scene<Dim> scene = parse_scene<Dim>(text, "s.toml");
  const std::string resolved = to_toml(scene);
  CHECK(to_toml(parse_scene<Dim>(resolved, "again.toml")) == resolved);
}

}  // namespace

TEST_SUITE("mutations") {
  TEST_CASE("spoilt scenes of the plane are refused in one sentence, or read") {
    const std::string more = R"([output]
frames_every = "5 ms"
[drag]
rate = 1
[[outlet]]
low = [-2, -2]
high = [-1, -1]
[[measure]]
region = { low = [0, 0], high = [1, 1] }
slices = 3
)";
    const std::string moving = R"(motion = { type = "shake", amplitude = [0, 1], frequency = 3 }
[[box]]
low = [0, 0]
high = [1, 1]
material = "rock"
open = ["top"]
)";
    const std::string turned = with(kHeap, "gravity = [0, -9.81]",
                                    "gravity = { times = [0, 1], values = [[0, -9.81], [1, 1]] }");
    check_spoilt({kHeap, kHeap + more, turned + moving}, read_text<2>);
  }

  TEST_CASE("spoilt scenes of space are refused in one sentence, or read") {
    const std::string cone = R"([[wall]]
point = [0, 0, 0]
axis = [0, 0, 1]
height = 1
radii = [1, 2]
turning = { type = "steady", axis = [0, 0, 1], rate = 1 }
)";
    const std::string plate = R"([[wall]]
corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
motion = { type = "path", times = [0, 1], shifts = [[0, 0, 0], [1, 0, 0]] }
)";
    check_spoilt({kSphere, in_space<3>(kHeap), kSphere + cone, kSphere + plate}, read_text<3>);
  }

  TEST_CASE("spoilt settings are refused in one sentence, or taken") {
    check_spoilt(
        {"law.friction=0.3", "fill[0].radius.uniform=[\"9 mm\", 0.01]", "wall[floor].point=[0, -1]",
         "materials.\"rock\".density=3 t/m^3", "gravity[1]=-1.6 m/s^2"},
        [](const std::string& text) { parse_scene<2>(kHeap, "s.toml", {text}); });
  }

  TEST_CASE("spoilt files of grains are refused in one sentence, or read") {
    const Folder folder;
    fs::create_directories(folder.path);
    const fs::path file = folder.path / "g.csv";
    Scene<2> scene = parse_scene<2>(kHeap, "s.toml");
    scene.fills.clear();
    scene.grains.clear();
    scene.walls.clear();
    scene.grain_files.emplace_back();
    scene.grain_files.back().file = file;
    scene.largest_initial_overlap = 1e9;
    check_spoilt({"id[-],x[m],y[m],vx[m/s],vy[m/s],radius[m],material[-]\n0,0.1,0.1,0,0,0.01,rock\n"
                  "1,0.2,0.1,0,0,0.01,\"gravel\"\n2,0.3,0.1,0,1e-3,0.01,rock\n",
                  "x,y,radius,material\r\n1,2,3,rock\r\n+4,5e0,6,\"gra\"\"vel\"\r\n"},
                 [&](const std::string& text) {
                   write_file(file, text);
                   place_grains(scene);
                 });
  }

  TEST_CASE("spoilt meshes are refused in one sentence, or read") {
    const Folder folder;
    fs::create_directories(folder.path);
    const std::string text =
        "solid plate\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid plate\n";
    std::string binary(80, ' ');
    binary += std::string("\x01\0\0\0", 4);
    for (const float value :
         {0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F}) {
      binary.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    binary += std::string(2, '\0');
    write_file(folder.path / "s.toml", kSphere + "[[wall]]\nmesh = \"m.stl\"\n");
    check_spoilt({text, binary}, [&](const std::string& spoilt) {
      write_file(folder.path / "m.stl", spoilt);
      read_scene<3>(folder.path / "s.toml");
    });
  }

  TEST_CASE("spoilt checkpoints are refused in one sentence, or read") {
    const Folder folder;
    const auto run = make_run(parse_scene<2>(with(kHeap, "\"20 ms\"", "\"1 ms\""), "s.toml"), 1);
    RecordOptions options;
    options.folder = folder.path;
    record(*run, options);
    const std::string bytes = read_file(folder.path / "checkpoint.h5");
    check_spoilt({bytes}, [&](const std::string& spoilt) {
      write_file(folder.path / "checkpoint.h5", spoilt);
      fs::remove(folder.path / "checkpoint_before.h5");
      resume_run<2>(read_checkpoint(folder.path), {}, 1);
    });
  }
}
