// SPDX-License-Identifier: GPL-3.0-or-later
#include "sieve3.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lagrain::detail {

void Sieve::sift(const View& view, const std::vector<Body>& balls, const std::vector<char>& is_cut,
                 int tile, bool flat, Drawn& drawn) {
  const int columns = (view.width + tile - 1) / tile, rows = (view.height + tile - 1) / tile;
  deepest_.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows),
                  std::numeric_limits<float>::infinity());
  order_.clear();
  for (std::size_t k = 0; k < balls.size(); ++k) {
    const float depth = -view.seen(balls[k].from)[2];
    if (!view.perspective || depth - balls[k].radius >= kLeastDepth) {
      order_.emplace_back(depth, k);
    }
  }
  std::sort(order_.begin(), order_.end());

  // Tiles per unit of the picture, and the picture's middle in tiles.
  const Vec2f size(static_cast<float>(view.width), static_cast<float>(view.height));
  const Vec2f scale = 0.5F / static_cast<float>(tile) * size.cwiseQuotient(view.half_size);
  const Vec2f middle =
      0.5F / static_cast<float>(tile) * size.cwiseProduct(view.jitter + Vec2f::Ones());
  for (const auto& [depth, k] : order_) {
    const Body& ball = balls[k];
    const Vec3f c = view.seen(ball.from);
    const float r = ball.radius;
    Vec2f low = c.head<2>() - Vec2f::Constant(r), high = c.head<2>() + Vec2f::Constant(r);
    Vec2f centre = c.head<2>();
    float covers = r, least = flat ? depth : depth - r, most = depth;
    if (view.perspective) {
      const float dd = depth * depth - r * r;
      for (int i = 0; i < 2; ++i) {
        const float root = r * std::sqrt(c[i] * c[i] + dd);
        low[i] = (c[i] * depth - root) / dd;
        high[i] = (c[i] * depth + root) / dd;
      }
      centre /= depth;
      covers /= depth;  // a disc across the line of sight, inside the ball's outline
      most += r * c.head<2>().norm() / c.norm();  // what is seen of the ball is nearer than this
    }
    low = low.cwiseProduct(scale) + middle;
    high = high.cwiseProduct(scale) + middle;
    centre = centre.cwiseProduct(scale) + middle;
    // Balls close to an eye may reach far beyond the picture: compare before rounding.
    const auto index = [](float at, int last) {
      return static_cast<int>(std::floor(std::clamp(at, 0.0F, static_cast<float>(last) + 1)));
    };
    const int x0 = index(low[0], columns), x1 = std::min(index(high[0], columns), columns - 1),
              y0 = index(low[1], rows), y1 = std::min(index(high[1], rows), rows - 1);
    bool hidden = true;
    for (int y = y0; y <= y1 && hidden; ++y) {
      const float* row = deepest_.data() + static_cast<std::ptrdiff_t>(y) * columns;
      for (int x = x0; x <= x1 && hidden; ++x) hidden = row[x] <= least;
    }
    if (hidden) continue;
    if (is_cut[k] != 0) {
      drawn.others.push_back(ball);
      continue;
    }
    drawn.balls.push_back(ball);
    // A hair smaller than the ball, so that rounding cannot make it hide too much.
    const Vec2f reach = 0.999F * covers * scale;
    for (int y = y0; y <= y1; ++y) {
      const float away = std::max(std::abs(static_cast<float>(y) - centre[1]),
                                  std::abs(static_cast<float>(y + 1) - centre[1])) /
                         reach[1];
      if (away >= 1) continue;
      const float half = reach[0] * std::sqrt(1 - away * away);
      const int first = std::max(x0, static_cast<int>(std::ceil(centre[0] - half))),
                end = std::min(x1 + 1, static_cast<int>(std::floor(centre[0] + half)));
      float* row = deepest_.data() + static_cast<std::ptrdiff_t>(y) * columns;
      for (int x = first; x < end; ++x) row[x] = std::min(row[x], most);
    }
  }
}

}  // namespace lagrain::detail
