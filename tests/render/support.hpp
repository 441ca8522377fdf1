// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Helpers of the render tests.

#include <lagrain/paint.hpp>

#include <support/files.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace lagrain::test {

/// A folder that is there, and empty at first.
struct MadeFolder : Folder {
  MadeFolder() { std::filesystem::create_directories(path); }
  bool empty() const { return std::filesystem::is_empty(path); }
};

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
