// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Bytes are read as a file of grains, and as a mesh.

#include "fuzz/one_line.hpp"
#include "support/files.hpp"

#include <lagrain/files.hpp>
#include <lagrain/placement.hpp>
#include <lagrain/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>

using namespace lagrain;

// libFuzzer knows it by this name.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const test::Folder folder;
  std::filesystem::create_directories(folder.path);
  const std::filesystem::path file = folder.path / "file";
  write_file(file, std::string(reinterpret_cast<const char*>(bytes), size));

  static const std::string head =
      "dimension = 3\nduration = 1\ngravity = [0, 0, -1]\nnormal = \"linear\"\n"
      "friction = \"none\"\n[law]\nstiffness = 1e6\nrestitution = 1\n[materials.rock]\n"
      "density = 1000\n";
  test::refuses_in_one_line([&] {
    Scene<3> scene =
        parse_scene<3>(head + "[[grains]]\nfile = \"" + file.string() + "\"\n", "s.toml");
    scene.largest_initial_overlap = 1e9;
    place_grains(scene);
  });
  static const std::string mesh = head + "[[grain]]\nposition = [0, 0, 0]\nradius = 1\n" +
                                  "[[wall]]\nmesh = \"" + file.string() + "\"\n";
  test::refuses_in_one_line([&] { parse_scene<3>(mesh, "s.toml"); });
  return 0;
}
