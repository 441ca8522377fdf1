// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/laguerre2.hpp>

#include <lagrain/check.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace lagrain {

namespace {

/// Keeps the part of a convex polygon where normal . x <= offset (Sutherland & Hodgman, Commun. ACM
/// 17 (1974) 32).
void cut(std::vector<Vec<2>>& polygon, std::vector<Vec<2>>& scratch, const Vec<2>& normal,
         double offset) {
  scratch.clear();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec<2>& p = polygon[k];
    const Vec<2>& q = polygon[(k + 1) % polygon.size()];
    const double beyond_p = normal.dot(p) - offset, beyond_q = normal.dot(q) - offset;
    if (beyond_p <= 0) scratch.push_back(p);
    if ((beyond_p < 0 && beyond_q > 0) || (beyond_p > 0 && beyond_q < 0)) {
      scratch.emplace_back(p + beyond_p / (beyond_p - beyond_q) * (q - p));
    }
  }
  polygon.swap(scratch);
}

}  // namespace

Columns<2> laguerre_cell(const Triangulation<2>& triangulation, int site,
                         const Eigen::AlignedBox2d& box) {
  LAGRAIN_EXPECTS(triangulation.contains(site), "site " + std::to_string(site) + " is not present");
  LAGRAIN_EXPECTS(!box.isEmpty(), "the box is empty");
  const auto hidden = triangulation.hidden();
  if (std::binary_search(hidden.begin(), hidden.end(), site)) return Columns<2>(2, 0);

  // Relative to the site, so that a far origin costs no digits.
  const Vec<2> centre = triangulation.site(site);
  const Vec<2> low = box.min() - centre, high = box.max() - centre;
  std::vector<Vec<2>> polygon{low, {high[0], low[1]}, high, {low[0], high[1]}};
  std::vector<Vec<2>> scratch;
  triangulation.for_each_neighbour(site, [&](int j) {
    const Vec<2> away = triangulation.site(j) - centre;
    const double lead = triangulation.weight(site) - triangulation.weight(j);
    cut(polygon, scratch, away, (away.squaredNorm() + lead) / 2);
  });
  Columns<2> cell(2, static_cast<Eigen::Index>(polygon.size()));
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    cell.col(static_cast<Eigen::Index>(k)) = polygon[k] + centre;
  }
  return cell;
}

double polygon_area(const Columns<2>& polygon) {
  double twice = 0;
  for (Eigen::Index k = 2; k < polygon.cols(); ++k) {
    const Vec<2> a = polygon.col(k - 1) - polygon.col(0), b = polygon.col(k) - polygon.col(0);
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return twice / 2;
}

}  // namespace lagrain
