// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Helpers of the render tests.

#include <lagrain/paint.hpp>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace lagrain::test {

/// A fresh folder, removed at the end of the test.
struct Folder {
  std::filesystem::path path;
  explicit Folder(const std::string& name)
      : path(std::filesystem::temp_directory_path() /
             ("lagrain_" + name + "_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  bool empty() const { return std::filesystem::is_empty(path); }
};

inline std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// One channel (0 red ... 3 alpha) of the pixel in column x and row y from the top.
inline int pixel(const Image& image, int x, int y, int channel) {
  return image.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                         static_cast<std::size_t>(x)) +
                    static_cast<std::size_t>(channel)];
}

/// Ink of a black-on-white picture in pixels: the sum of its coverage.
inline double ink(const Image& image) {
  double sum = 0;
  for (std::size_t k = 0; k < image.rgba.size(); k += 4) sum += 255 - image.rgba[k];
  return sum / 255;
}

/// Peak signal-to-noise ratio of two pictures of one size [dB].
inline double psnr(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.rgba.size(); ++k) {
    const double d = a.rgba[k] - b.rgba[k];
    sum += d * d;
  }
  const double mean = sum / static_cast<double>(a.rgba.size());
  return mean > 0 ? 10 * std::log10(255 * 255 / mean) : 200;
}

/// What the figures consist of: cells, edges, discs, contacts, labels, a plot, a colour bar.
DisplayList mixed_list();

/// Balls in a box on a floor, tubes, lines and a cut among them.
Scene3 heap();

}  // namespace lagrain::test
