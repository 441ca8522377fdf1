// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How a camera or a light sees balls, and which of them it sees at all. Lengths are in any one
/// unit; single precision, because this is what goes to the shaders. Private to render.

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace lagrain::detail {

using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;

/// A ball, tube or line, as the vertex shaders read it.
struct Body {
  std::array<float, 3> from{};
  float radius = 0;  ///< of a line: half its width in pixels
  std::array<float, 3> to{};
  float id = 0;
};
static_assert(sizeof(Body) == 32);

/// Least distance of a body before the eye of a perspective view.
inline constexpr float kLeastDepth = 1e-5F;

/// A camera or a light, as the shaders need it.
struct View {
  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();  ///< rows: right, up, towards the viewer
  Vec3f shift = Vec3f::Zero();      ///< the origin, seen from the eye along these axes
  Vec2f half_size = Vec2f::Ones();  ///< of the picture; perspective: at depth 1
  Vec2f jitter = Vec2f::Zero();     ///< of the picture, where 2 is its size
  bool perspective = false;
  float nearest = 0, extent = 1;  ///< range of depths
  int x = 0;                      ///< of the picture's left column in its framebuffer [px]
  int width = 0, height = 0;      ///< [px]

  Vec3f seen(const std::array<float, 3>& p) const {
    return axes * Eigen::Map<const Vec3f>(p.data()) + shift;
  }
};

/// The bodies that a view has to draw.
struct Drawn {
  std::vector<Body> balls;   ///< whole
  std::vector<Body> others;  ///< cut balls, tubes
};

/// Leaves out balls that are wholly hidden behind nearer ones: most of a packing, for every view.
/// On a grid of tiles, a ball hides whatever lies behind it in the tiles that it covers entirely.
/// The picture is exactly the same without.
class Sieve {
 public:
  /// Adds to `drawn` the balls that are not hidden.
  /// @param is_cut for each ball: only a part is left of it, it hides nothing
  /// @param tile side of a tile in pixels
  /// @param flat balls are discs at the depth of their centres, as in shadow maps
  void sift(const View& view, const std::vector<Body>& balls, const std::vector<char>& is_cut,
            int tile, bool flat, Drawn& drawn);

 private:
  std::vector<float> deepest_;  // of what is seen in a tile
  std::vector<std::pair<float, std::size_t>> order_;
};

}  // namespace lagrain::detail
