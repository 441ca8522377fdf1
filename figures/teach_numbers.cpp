// SPDX-License-Identifier: GPL-3.0-or-later
#include "teach_numbers.hpp"

#include "teach/lab.hpp"

#include <lagrain/check.hpp>
#include <lagrain/laguerre2.hpp>
#include <lagrain/predicates2.hpp>
#include <lagrain/random.hpp>
#include <lagrain/skins.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/words.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <numbers>
#include <set>

namespace lagrain::figures {
namespace {

/// Sites x, y, r of the plane, triangulated with weights r^2.
Triangulation<2> triangulated(const std::vector<std::array<double, 3>>& discs) {
  Columns<2> x(2, static_cast<Eigen::Index>(discs.size()));
  Eigen::VectorXd w(x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const auto& [px, py, r] = discs[static_cast<std::size_t>(i)];
    x.col(i) << px, py;
    w[i] = r * r;
  }
  Triangulation<2> t;
  t.build(x, w);
  return t;
}

bool has_edge(Triangulation<2>& t, int i, int j) {
  const EdgeList::Edge edge{std::min(i, j), std::max(i, j)};
  return std::binary_search(t.edges().begin(), t.edges().end(), edge);
}

constexpr int kHalvings = 50;

/// Where a condition changes from false to true between two numbers.
template <class Condition>
double threshold(double low, double high, Condition&& holds) {
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? high : low) = middle;
  }
  return high;
}

double border() {
  auto t = triangulated({{0, 0, 1}, {4, 0, 2}});
  const Eigen::AlignedBox2d box(Vec<2>(-10, -10), Vec<2>(10, 10));
  return laguerre_cell(t, 0, box).row(0).maxCoeff();
}

double lifted_radius() {
  return threshold(0, 2, [](double r) {
    return triangulated({{-1, 0, 1.5}, {0, 0, r}, {1, 0, 1.5}}).hidden().empty();
  });
}

double hidden_radius() {
  return threshold(0, 2, [](double r) {
    const auto t =
        triangulated({{0, 0, r}, {1, 0, 1.25}, {-1, 0, 1.25}, {0, 1, 1.25}, {0, -1, 1.25}});
    return t.hidden().empty();
  });
}

constexpr int kMapSide = 128;  // as the bench has it
double wrong_signs() { return sign_map(kMapSide, 0.5, 0.5, 12, 12, 24, 24); }

/// Twelve sites, five of them on the hull.
double edges_of_12() {
  std::vector<std::array<double, 3>> discs;
  for (int k = 0; k < 5; ++k) {
    const double angle = 2 * std::numbers::pi * k / 5;
    discs.push_back({10 * std::cos(angle), 10 * std::sin(angle), 0.1});
  }
  Random random(1);
  for (int k = 0; k < 7; ++k) discs.push_back({random.uniform(-4, 4), random.uniform(-4, 4), 0.1});
  auto t = triangulated(discs);
  return static_cast<double>(t.edges().size());
}

double right_angle_share() {
  return threshold(0, 1, [](double overlap) {
    return !passes_certificate((2 - overlap) * (2 - overlap), 1, 1);
  });
}

double skin_at_once() {
  return threshold(
      0, 1, [](double s) { return !passes_certificate(4, weight_with(1, s), weight_with(1, s)); });
}

/// Sites 7, 3, 5, 9 around a square; the other numbers are far away.
double diagonal_sum() {
  std::vector<std::array<double, 3>> discs;
  for (int k = 0; k < 10; ++k) discs.push_back({100.0 + k, 100.0 * k, 0.5});
  discs[7] = {0, 0, 0.5};
  discs[3] = {1, 0, 0.5};
  discs[5] = {1, 1, 0.5};
  discs[9] = {0, 1, 0.5};
  auto t = triangulated(discs);
  return has_edge(t, 5, 7) ? 5 + 7 : 3 + 9;
}

double verlet_error() {
  constexpr int kVerlet = 1;
  impact(kVerlet, 25, 0.5);
  return 100 * lagrain_reals()[1];
}

const std::map<std::string, std::function<double()>>& all_numbers() {
  static const std::map<std::string, std::function<double()>> numbers{
      {"border", border},
      {"lifted_radius", lifted_radius},
      {"spacing", [] { return (std::nextafter(8.0, 16.0) - 8) * 1e15; }},
      {"wrong_signs", wrong_signs},
      {"all_signs", [] { return kMapSide * kMapSide; }},
      {"edges_of_12", edges_of_12},
      {"tetrahedra_after", [] { return 10 + 4 * (3 - 2) + (2 - 3) + (4 - 1) + 2 * (4 - 4); }},
      {"hidden_radius", hidden_radius},
      {"hidden_halvings", [] { return kHalvings; }},
      {"right_angle_share", right_angle_share},
      {"right_angle_overlap", [] { return 10 * right_angle_share(); }},
      {"first_miss", [] { return (30.0 - 2 * 5) / (2 + 2); }},
      {"skin_at_once", skin_at_once},
      {"skin_any_time", [] { return fair_skin(1, 1, 4); }},
      {"skin_mm", [] { return 10 * skin_at_once(); }},
      {"diagonal_sum", diagonal_sum},
      {"restitution", [] { return std::sqrt(0.36); }},
      {"steps_needed", [] { return 25 * std::sqrt(0.4 / 0.1); }},
      {"verlet_error", verlet_error},
  };
  return numbers;
}

using Triangle = std::array<int, 3>;

/// Sites and the exact signs that flips ask for.
class Flips {
 public:
  explicit Flips(const FlipStart& start) {
    for (const auto& site : start.sites) sites_.push_back({site[0], site[1], site[2] * site[2]});
  }
  int turn(int a, int b, int c) const { return orientation(at(a), at(b), at(c)); }

  /// Every triangulation that is one flip away.
  /// @param sign  +1: of a bad edge, after which the lifted surface lies lower; -1: of a good one
  std::vector<std::set<Triangle>> neighbours(const std::set<Triangle>& triangles, int sign) const {
    std::map<std::pair<int, int>, int> opposite;
    for (const Triangle& t : triangles) {
      for (std::size_t k = 0; k < 3; ++k) opposite[{t[k], t[(k + 1) % 3]}] = t[(k + 2) % 3];
    }
    std::vector<std::set<Triangle>> found;
    for (const auto& [edge, c] : opposite) {
      const auto [a, b] = edge;
      const auto other = opposite.find({b, a});
      if (a > b || other == opposite.end()) continue;
      const int d = other->second;
      if (sign * power_side(at(a), at(b), at(c), at(d)) <= 0) continue;
      if (turn(c, d, b) <= 0 || turn(d, c, a) <= 0) continue;
      auto next = triangles;
      next.erase(rotated({a, b, c}));
      next.erase(rotated({b, a, d}));
      next.insert(rotated({c, d, b}));
      next.insert(rotated({d, c, a}));
      found.push_back(std::move(next));
    }
    return found;
  }
  /// The same triangle with its smallest corner first.
  static Triangle rotated(Triangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  }

 private:
  const Site2& at(int i) const { return sites_[static_cast<std::size_t>(i)]; }
  std::vector<Site2> sites_;
};

std::set<Triangle> triangles_of(const FlipStart& start) {
  std::set<Triangle> triangles;
  for (const auto& t : start.triangles) triangles.insert(Flips::rotated({t[0], t[1], t[2]}));
  return triangles;
}

}  // namespace

double lesson_number(const std::string& name) {
  const auto found = all_numbers().find(name);
  if (found != all_numbers().end()) return found->second();
  throw SceneError("there is no number " + shown(name) + suggestion(name, lesson_numbers()));
}

std::vector<std::string> lesson_numbers() {
  std::vector<std::string> names;
  for (const auto& [name, compute] : all_numbers()) names.push_back(name);
  return names;
}

FlipStart disordered_triangulation(std::vector<std::vector<double>> sites) {
  FlipStart start{std::move(sites), {}};
  const Flips flips(start);
  const int n = static_cast<int>(start.sites.size());
  std::vector<int> order(start.sites.size());
  for (int i = 0; i < n; ++i) order[static_cast<std::size_t>(i)] = i;
  const auto& places = start.sites;
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return places[static_cast<std::size_t>(a)] < places[static_cast<std::size_t>(b)];
  });
  std::vector<int> hull{order[0], order[1]};  // counter-clockwise
  for (std::size_t k = 2; k < order.size(); ++k) {
    const int site = order[k];
    const auto sees = [&](std::size_t e) {
      return flips.turn(hull[e], hull[(e + 1) % hull.size()], site) < 0;
    };
    // The site sees a chain of the hull: let it begin at the first edge.
    while (!sees(0) || sees(hull.size() - 1))
      std::rotate(hull.begin(), hull.begin() + 1, hull.end());
    std::size_t seen = 0;
    for (; sees(seen); ++seen) start.triangles.push_back({hull[seen + 1], hull[seen], site});
    std::vector<int> next(hull.begin() + static_cast<std::ptrdiff_t>(seen), hull.end());
    next.insert(next.end(), {hull[0], site});
    hull = std::move(next);
  }
  // Then good edges are flipped while there are some.
  std::set<Triangle> now = triangles_of(start);
  for (auto next = flips.neighbours(now, -1); !next.empty(); next = flips.neighbours(now, -1)) {
    now = next.front();
  }
  start.triangles.clear();
  for (const Triangle& t : now) start.triangles.push_back({t[0], t[1], t[2]});
  return start;
}

int least_flips(const FlipStart& start) {
  const Flips flips(start);
  const std::set<Triangle> first = triangles_of(start);
  std::map<std::set<Triangle>, int> distance{{first, 0}};
  std::deque<std::set<Triangle>> waiting{first};
  while (!waiting.empty()) {
    const auto now = waiting.front();
    waiting.pop_front();
    const auto next = flips.neighbours(now, +1);
    if (next.empty()) return distance[now];  // no bad edge that could be flipped: T
    for (const auto& triangulation : next) {
      if (distance.emplace(triangulation, distance[now] + 1).second) {
        waiting.push_back(triangulation);
      }
    }
  }
  return 0;
}

}  // namespace lagrain::figures
