// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/overlap_estimate.hpp>

#include <lagrain/contact_laws.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <variant>
#include <vector>

namespace lagrain {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Places seen along gravity: a height, and what is left across it.
template <int Dim>
class Plumb {
 public:
  using Across = Eigen::Matrix<double, Dim - 1, 1>;

  explicit Plumb(const Vec<Dim>& gravity) : down_(gravity.normalized()) {
    if constexpr (Dim == 2) {
      axes_.row(0) = Vec<2>(-down_[1], down_[0]).transpose();
    } else {
      axes_.row(0) = down_.unitOrthogonal().transpose();
      axes_.row(1) = down_.cross(Vec<3>(axes_.row(0).transpose())).transpose();
    }
  }
  const Vec<Dim>& down() const { return down_; }
  double height(const Vec<Dim>& x) const { return -x.dot(down_); }
  Across across(const Vec<Dim>& x) const { return axes_ * x; }

 private:
  Vec<Dim> down_;
  Eigen::Matrix<double, Dim - 1, Dim> axes_;
};

/// Numbers of a square of a grid across gravity.
template <int Dim>
using Square = std::array<std::int64_t, Dim - 1>;

template <int Dim>
Square<Dim> square_of(const typename Plumb<Dim>::Across& at, double width) {
  constexpr double kFar = 9e18;  // beyond it the numbers of squares end, and all is one square
  Square<Dim> square;
  for (std::size_t d = 0; d < square.size(); ++d) {
    square[d] = static_cast<std::int64_t>(
        std::clamp(std::floor(at[static_cast<Eigen::Index>(d)] / width), -kFar, kFar));
  }
  return square;
}

/// Visits all squares from low to high.
template <std::size_t N, class F>
void for_each_square(const std::array<std::int64_t, N>& low,
                     const std::array<std::int64_t, N>& high, F&& f) {
  std::array<std::int64_t, N> at = low;
  for (bool more = true; more;) {
    f(at);
    more = false;
    for (std::size_t d = 0; d < N && !more; ++d) {
      more = at[d] < high[d];
      at[d] = more ? at[d] + 1 : low[d];
    }
  }
}

/// Grains that stand on each other.
struct Column {
  double mass = 0;   // [kg]
  double radii = 0;  // sum of them [m]
  double count = 0;

  void add(const Column& other) {
    mass += other.mass;
    radii += other.radii;
    count += other.count;
  }
};

/// The heaviest column, one mean diameter wide, of the grains that move. It may stand anywhere: the
/// grid has squares of half the width, and a column is two of them wide.
template <int Dim>
Column heaviest_column(const Run<Dim>& run, const std::vector<int>& movable,
                       const Plumb<Dim>& plumb, double mean_radius) {
  std::map<Square<Dim>, Column> squares;
  for (const int i : movable) {
    squares[square_of<Dim>(plumb.across(run.positions().col(i)), mean_radius)].add(
        {run.masses()[i], run.radii()[i], 1});
  }
  Column heaviest;
  for (const auto& [square, unused] : squares) {
    Square<Dim> next = square;
    for (std::int64_t& k : next) ++k;
    Column column;
    for_each_square(square, next, [&](const Square<Dim>& part) {
      if (const auto found = squares.find(part); found != squares.end()) column.add(found->second);
    });
    if (column.mass > heaviest.mass) heaviest = column;
  }
  return heaviest;
}

/// How far a grain falls until it touches a wall [m]; infinity if it never does.
template <int Dim>
double fall_to_wall(const Wall<Dim>& wall, Vec<Dim> x, double radius, const Vec<Dim>& down) {
  constexpr int kMostSteps = 50;
  double fallen = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    const auto foot = wall.foot(x);
    const double gap = foot.distance - radius;
    const double approach = -foot.normal.dot(down);
    if (std::holds_alternative<HalfSpace<Dim>>(wall.shape)) {
      return approach > 0 ? std::max(0.0, gap / approach) : kInfinity;
    }
    const bool bears = approach > 0.1;  // a steeper wall is slid along
    if (bears && gap < 1e-3 * radius) return fallen;
    // No place within the gap can touch: walls are given by distances.
    const double stride = bears ? gap : std::max(gap, 0.5 * radius);
    fallen += stride;
    x += stride * down;
  }
  return kInfinity;
}

/// How far each grain falls if all fall straight down, the lowest first, each until it touches a
/// wall or one that has landed [m]; infinity if nothing stops it.
template <int Dim>
std::vector<double> falls(const Run<Dim>& run, const std::vector<bool>& moves,
                          const Plumb<Dim>& plumb, double mean_radius) {
  struct Landed {
    typename Plumb<Dim>::Across at;
    double height;
    double radius;
    int grain;
    double top;  // of all so far in this square
  };
  const auto& radii = run.radii();
  // No grain lies in too many squares, and few in one.
  const double width = std::max(2 * mean_radius, radii.maxCoeff() / 50);
  std::map<Square<Dim>, std::vector<Landed>> squares;
  const auto visit = [&](const auto& at, double r, auto&& f) {
    const typename Plumb<Dim>::Across reach = Plumb<Dim>::Across::Constant(r);
    for_each_square(square_of<Dim>(at - reach, width), square_of<Dim>(at + reach, width), f);
  };

  std::vector<double> heights(moves.size());
  for (std::size_t i = 0; i < moves.size(); ++i) {
    heights[i] = plumb.height(run.positions().col(static_cast<Eigen::Index>(i)));
  }
  std::vector<std::size_t> upwards(moves.size());
  std::iota(upwards.begin(), upwards.end(), std::size_t{0});
  std::sort(upwards.begin(), upwards.end(),
            [&](std::size_t i, std::size_t j) { return heights[i] < heights[j]; });

  std::vector<double> fallen(moves.size(), 0.0);
  for (const std::size_t i : upwards) {
    const auto column = static_cast<Eigen::Index>(i);
    const Vec<Dim> x = run.positions().col(column);
    const double r = radii[column];
    const auto at = plumb.across(x);
    if (moves[i]) {
      double landing = -kInfinity;
      for (const Wall<Dim>& wall : run.walls()) {
        if (!run.rules().may_touch(static_cast<int>(i), wall)) continue;
        landing = std::max(landing, heights[i] - fall_to_wall(wall, x, r, plumb.down()));
      }
      visit(at, r, [&](const Square<Dim>& square) {
        const auto found = squares.find(square);
        if (found == squares.end()) return;
        for (auto below = found->second.rbegin(); below != found->second.rend(); ++below) {
          if (below->top + r <= landing) break;
          if (!run.rules().may_touch({static_cast<int>(i), below->grain})) continue;
          const double reach = r + below->radius;
          const double room = reach * reach - (at - below->at).squaredNorm();
          if (room > 0) landing = std::max(landing, below->height + std::sqrt(room));
        }
      });
      fallen[i] = std::max(0.0, heights[i] - landing);
    }
    const double height = heights[i] - fallen[i];
    if (!std::isfinite(height)) continue;  // nothing lands on what falls for ever
    visit(at, r, [&](const Square<Dim>& square) {
      auto& landed = squares[square];
      const double top = landed.empty() ? -kInfinity : landed.back().top;
      landed.push_back({at, height, r, static_cast<int>(i), std::max(top, height + r)});
    });
  }
  return fallen;
}

/// The overlap [m] at which a growing function of it reaches a value.
template <class F>
double overlap_where(F&& f, double value) {
  if (!(value > 0)) return 0;
  double low = 0;
  double high = 1e-9;
  while (f(high) < value && high < 1e9) low = std::exchange(high, 2 * high);
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (f(middle) < value ? low : high) = middle;
  }
  return high;
}

/// The energy that the spring of a head-on impact holds when it is deepest, of the energy before
/// [-]: the square of the largest deflection of a damped oscillator that starts with a speed. Along
/// (4/5) overlap^(5/4) Hertz's contact is that oscillator too (see Hertz).
double share_held(double damping_ratio) {
  const double z = damping_ratio;
  if (z == 0) return 1;
  if (z == 1) return std::exp(-2.0);
  const double root = std::sqrt(std::abs(1 - z * z));
  return std::exp(-2 * z / root * (z < 1 ? std::acos(z) : std::acosh(z)));
}

/// A grain that hits a wall.
struct Impact {
  double mass = 0;    // [kg]
  double radius = 0;  // [m]
  double speed = 0;   // [m/s]
};

/// What a normal law makes of loads and impacts.
template <int Dim, class Normal>
class Softness {
 public:
  explicit Softness(const LawNumbers& numbers) : law_(NormalLawEntry<Normal>::make(numbers)) {}

  /// Overlap, of the radius [-], of the lowest grain of a column with what is below it: the floor,
  /// or another grain.
  double under(const Column& column, double gravity) const {
    if (column.count == 0) return 0;
    const double radius = column.radii / column.count;
    const auto overlap = [&](double load, double effective_radius) {
      return overlap_where(
          [&](double depth) { return law_.elastic_force(touch(depth, effective_radius)); }, load);
    };
    const double load = gravity * column.mass;
    return std::max(overlap(load, radius), overlap(load * (1 - 1 / column.count), radius / 2)) /
           radius;
  }

  /// Overlap, of the radius [-].
  double in(const Impact& impact) const {
    const double held =
        0.5 * impact.mass * impact.speed * impact.speed * share_held(law_.largest_damping_ratio());
    return overlap_where(
               [&](double depth) {
                 return law_.elastic_energy(touch(depth, impact.radius), NoMemory{});
               },
               held) /
           impact.radius;
  }

 private:
  static Touch<Dim> touch(double overlap, double effective_radius) {
    Touch<Dim> touch;
    touch.overlap = overlap;
    touch.effective_radius = effective_radius;
    return touch;
  }

  Normal law_;
};

template <int Dim, class Normal>
OverlapEstimate estimate_with(const Run<Dim>& run) {
  const Scene<Dim>& scene = run.scene();
  // The first key of a normal law is the one that all its forces grow with.
  const auto stiffness = NormalLawEntry<Normal>::kKeys[0].number;
  LawNumbers softest = scene.law;
  for (const PairLaw& pair : scene.pairs) {
    if (pair.law.*stiffness < softest.*stiffness) softest = pair.law;
  }

  std::vector<int> movable;
  std::vector<bool> moves;
  double radii = 0;
  for (int i = 0; i < run.count(); ++i) {
    moves.push_back(!run.pinned()[i]);
    if (!moves.back()) continue;
    movable.push_back(i);
    radii += run.radii()[i];
  }
  if (movable.empty()) return {};
  const double mean_radius = radii / static_cast<double>(movable.size());

  const double g = scene.gravity.norm();
  Column column;
  std::vector<double> fallen(moves.size(), 0.0);
  if (g > 0) {
    const Plumb<Dim> plumb(scene.gravity);
    column = heaviest_column(run, movable, plumb, mean_radius);
    fallen = falls(run, moves, plumb, mean_radius);
  }

  const Softness<Dim, Normal> softness(softest);
  OverlapEstimate estimate;
  estimate.load = g * column.mass;
  estimate.overlap_of_load = softness.under(column, g);
  Impact deepest;
  for (const int i : movable) {
    const double start = run.velocities().col(i).norm();
    const double fall = fallen[static_cast<std::size_t>(i)];
    const double landing = std::isfinite(fall) ? std::sqrt(start * start + 2 * g * fall) : start;
    const Impact impact{run.masses()[i], run.radii()[i],
                        std::min(landing, start + g * scene.duration)};
    const double overlap = softness.in(impact);
    if (overlap <= estimate.overlap_of_impact) continue;
    estimate.overlap_of_impact = overlap;
    deepest = impact;
  }
  estimate.speed = deepest.speed;
  if (estimate.overlap() == 0) return estimate;

  double low = 1e-12;  // of the scene's stiffness
  double high = 1e12;
  for (int k = 0; k < 100; ++k) {
    const double middle = std::sqrt(low * high);
    LawNumbers tried = softest;
    tried.*stiffness *= middle;
    const Softness<Dim, Normal> stiffer(tried);
    (stiffer.under(column, g) + stiffer.in(deepest) > kSoundOverlap ? low : high) = middle;
  }
  estimate.stiffness = high * softest.*stiffness;
  return estimate;
}

}  // namespace

template <int Dim>
OverlapEstimate estimate_overlap(const Run<Dim>& run) {
  switch (run.scene().normal) {
#define LAGRAIN_CASE(word, Normal) \
  case NormalModel::word:          \
    return estimate_with<Dim, Normal>(run);
    LAGRAIN_NORMAL_LAWS(LAGRAIN_CASE)
#undef LAGRAIN_CASE
  }
  throw ContractError("a scene names no normal law");
}

template OverlapEstimate estimate_overlap<2>(const Run<2>&);
template OverlapEstimate estimate_overlap<3>(const Run<3>&);

}  // namespace lagrain
