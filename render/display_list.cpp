// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/display_list.hpp>

#include <lagrain/check.hpp>

#include <algorithm>
#include <numeric>

namespace lagrain {

Panel::Panel(const Box& page, const Box& world) {
  LAGRAIN_EXPECTS(page.size().minCoeff() > 0 && world.size().minCoeff() > 0,
                  "Panel: a rectangle is empty");
  scale_ = (page.size().array() / world.size().array()).minCoeff();
  origin_ = page.centre() - scale_ * world.centre();
  box_ = {point(world.low), point(world.high)};
}

std::vector<Vec<2>> corners(const Box& box) {
  return {box.low, {box.high[0], box.low[1]}, box.high, {box.low[0], box.high[1]}};
}

std::vector<std::vector<Vec<2>>> dashed(const Polyline& line) {
  if (line.points.empty()) return {};
  if (line.dashes.empty()) return {line.points};
  LAGRAIN_EXPECTS(*std::min_element(line.dashes.begin(), line.dashes.end()) >= 0 &&
                      std::accumulate(line.dashes.begin(), line.dashes.end(), 0.0) > 0,
                  "dashed: lengths of dashes are negative or all zero");

  std::vector<std::vector<Vec<2>>> pieces{{line.points.front()}};
  std::size_t turn = 0;  // even: dash, odd: gap
  double left = line.dashes[0];
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    Vec<2> from = line.points[i - 1];
    double length = (line.points[i] - from).norm();
    while (length > left) {
      from += left / length * (line.points[i] - from);
      length -= left;
      if (turn % 2 == 0) {
        pieces.back().push_back(from);
      } else {
        pieces.push_back({from});
      }
      ++turn;
      left = line.dashes[turn % line.dashes.size()];
    }
    left -= length;
    if (turn % 2 == 0) pieces.back().push_back(line.points[i]);
  }
  return pieces;
}

}  // namespace lagrain
