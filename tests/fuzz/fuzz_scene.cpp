// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A text is read as a scene of the plane and of space. What is read is written and read again.

#include "fuzz/one_line.hpp"

#include <lagrain/scene.hpp>

#include <cstddef>
#include <cstdint>

using namespace lagrain;

namespace {

template <int Dim>
void read(const std::string& text) {
  test::refuses_in_one_line([&] {
    const std::string resolved = to_toml(parse_scene<Dim>(text, "s.toml"));
    if (to_toml(parse_scene<Dim>(resolved, "again.toml")) != resolved) std::abort();
  });
}

}  // namespace

// libFuzzer knows it by this name.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  read<2>(text);
  read<3>(text);
  return 0;
}
