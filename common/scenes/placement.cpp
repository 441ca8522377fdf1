// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/placement.hpp>

#include "grain_file.hpp"
#include "placing.hpp"
#include "pushing.hpp"
#include "start.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/random.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <unordered_map>

namespace lagrain {
namespace {

using detail::clear_of_walls;
using detail::grain_from;
using detail::largest;
using detail::RadiusDraw;

/// Spacing of a lattice in largest diameters: the surplus is the room for jitter.
constexpr double kSpacing = 1.02;
/// Places tried for one grain before its region counts as full.
constexpr int kTries = 2000;
/// Then fewer are tried, and the least bad is taken.
constexpr int kTriesWhenFull = 30;
/// Steps of pushing after which a region counts as too small.
constexpr int kPushes = 3000;

/// Solid fraction of the densest packing of equal discs (Thue, Norske Vid. Selsk. Skr. 1 (1910) 1)
/// or spheres (Hales, Ann. Math. 162 (2005) 1065), and about the densest at random [-].
template <int Dim>
constexpr double kDensest = Dim == 2 ? 0.9068996821171089 : 0.7404804896930610;
template <int Dim>
constexpr double kDensestRandom = Dim == 2 ? 0.84 : 0.64;

/// Finds the grains near a place. Grains of like size share a grid of cells that are one to two of
/// their diameters wide, and each is listed in every cell that its bounding box meets, so that any
/// mixture of sizes works. It is a hierarchical grid (Ericson, Real-Time Collision Detection, 2005,
/// section 7.2).
template <int Dim>
class Occupied {
 public:
  /// @param usual  radii of which there may be many, and none larger of the same kind [m]
  explicit Occupied(const std::vector<double>& usual) {
    for (const double r : usual) grid_for(r);
  }

  void add(int grain, const Vec<Dim>& x, double r) {
    Grid& grid = grid_for(r);
    grid.grains.push_back(grain);
    visit_cells(Cells(grid, x, r), [&](std::uint64_t key) {
      grid.cells[key].push_back(grain);
      return true;
    });
  }
  /// Visits all grains that touch the ball and some more, some more than once, until f fails.
  template <class F>
  void for_each_near(const Vec<Dim>& x, double r, F&& f) const {
    for (const Grid& grid : grids_) {
      const Cells cells(grid, x, r);
      const auto look_into = [&](std::uint64_t key) {
        const auto found = grid.cells.find(key);
        return found == grid.cells.end() ||
               std::all_of(found->second.begin(), found->second.end(), f);
      };
      // A large ball among few small grains: to look at each is less than to look into each cell.
      const bool more = cells.count() > static_cast<double>(grid.grains.size())
                            ? std::all_of(grid.grains.begin(), grid.grains.end(), f)
                            : visit_cells(cells, look_into);
      if (!more) return;
    }
  }

 private:
  /// Grains with radii from a quarter to half of a cell.
  struct Grid {
    double cell;              // its width [m]
    std::vector<int> grains;  // all
    // A key shared by accident only costs.
    std::unordered_map<std::uint64_t, std::vector<int>> cells;
  };

  /// The cells of a grid that the bounding box of a ball meets.
  struct Cells {
    std::array<std::int64_t, Dim> low, high;

    Cells(const Grid& grid, const Vec<Dim>& x, double r) {
      constexpr double kFar = 9e18;  // beyond it the numbers of cells end, and all is one cell
      const auto cell_of = [&](double place) {
        return static_cast<std::int64_t>(std::clamp(std::floor(place / grid.cell), -kFar, kFar));
      };
      for (std::size_t d = 0; d < Dim; ++d) {
        const auto k = static_cast<Eigen::Index>(d);
        low[d] = cell_of(x[k] - r);
        high[d] = cell_of(x[k] + r);
      }
    }
    double count() const {
      double count = 1;
      for (std::size_t d = 0; d < Dim; ++d) {
        count *= static_cast<double>(high[d]) - static_cast<double>(low[d]) + 1;
      }
      return count;
    }
  };

  Grid& grid_for(double r) {
    for (Grid& grid : grids_) {
      if (r <= grid.cell / 2 && r > grid.cell / 4) return grid;
    }
    return grids_.emplace_back(Grid{2 * r, {}, {}});
  }

  /// Visits the keys of cells until f returns false.
  /// @return whether it never did
  template <class F>
  static bool visit_cells(const Cells& cells, F&& f) {
    std::array<std::int64_t, Dim> at = cells.low;
    for (bool more = true; more;) {
      std::uint64_t key = 0;
      for (std::size_t d = 0; d < Dim; ++d) {
        key = key * 0x9E3779B97F4A7C15ULL + static_cast<std::uint64_t>(at[d]);
      }
      if (!f(key)) return false;
      more = false;
      for (std::size_t d = 0; d < Dim && !more; ++d) {
        more = at[d] < cells.high[d];
        at[d] = more ? at[d] + 1 : cells.low[d];
      }
    }
    return true;
  }

  std::vector<Grid> grids_;
};

template <int Dim>
class Placer {
 public:
  Placer(const Scene<Dim>& scene, const PlacementWatch& watch)
      : scene_(scene),
        watch_(watch),
        apart_(scene.apart()),
        start_(start_of(scene)),
        walls_(start_.walls),
        listed_(read_files(scene)),
        occupied_(usual_radii(scene)) {
    for (Wall<Dim>& wall : walls_) wall.advance(0, 0);
    asked_ = static_cast<std::int64_t>(start_.grains.size() + scene.grains.size());
    for (const auto& file : listed_) asked_ += static_cast<std::int64_t>(file.grains.size());
    for (const Fill<Dim>& f : scene.fills) asked_ += f.count.value_or(0);
  }

  Placement<Dim> place() {
    for (const PlacedGrain<Dim>& grain : start_.grains) place_as_it_was(grain);
    for (const PlacedGrain<Dim>& grain : scene_.grains) place_by_hand(grain);
    for (const auto& file : listed_) {
      for (const PlacedGrain<Dim>& grain : file.grains) place_by_hand(grain);
    }
    for (std::size_t f = 0; f < scene_.fills.size(); ++f) fill(f);
    placed_.walls = std::move(start_.walls);
    placed_.recalled = std::move(start_.recalled);
    placed_.origin = std::move(start_.origin);
    return std::move(placed_);
  }

 private:
  static detail::Start<Dim> start_of(const Scene<Dim>& scene) {
    if (scene.start) return detail::read_start(scene);
    detail::Start<Dim> nothing;
    nothing.walls = scene.walls;
    return nothing;
  }
  static std::vector<detail::ListedGrains<Dim>> read_files(const Scene<Dim>& scene) {
    std::vector<detail::ListedGrains<Dim>> files;
    for (std::size_t k = 0; k < scene.grain_files.size(); ++k) {
      files.push_back(detail::read_grains(scene, k));
    }
    return files;
  }

  static std::vector<double> usual_radii(const Scene<Dim>& scene) {
    std::vector<double> radii;
    for (const Fill<Dim>& f : scene.fills) radii.push_back(largest(f.radius));
    return radii;
  }

  /// Lets whoever waits look, and stop.
  void look() const {
    if (watch_) watch_(static_cast<std::int64_t>(placed_.grains.size()), asked_);
  }

  /// A refusal of a grain that no fill has placed: by the scene's key, or by file and line.
  SceneError refusal(std::size_t grain, const std::string& message) const {
    const std::size_t of_start = start_.grains.size();
    if (grain < of_start) return scene_.error("start", name_of(grain) + " " + message);
    return grain - of_start < scene_.grains.size() ? scene_.error(name_of(grain), message)
                                                   : SceneError(name_of(grain) + ": " + message);
  }
  std::string name_of(std::size_t grain) const {
    if (grain < start_.ids.size()) {
      return "grain " + std::to_string(start_.ids[grain]) + " of " + scene_.start->run.string();
    }
    grain -= start_.ids.size();
    if (grain < scene_.grains.size()) return "grain[" + std::to_string(grain) + "]";
    grain -= scene_.grains.size();
    std::size_t file = 0;
    for (; grain >= listed_[file].grains.size(); ++file) grain -= listed_[file].grains.size();
    return scene_.grain_files[file].file.string() + ":" +
           std::to_string(listed_[file].lines[grain]);
  }

  void place_by_hand(const PlacedGrain<Dim>& p) {
    const std::size_t index = placed_.grains.size();
    const double limit = scene_.largest_initial_overlap;
    const auto overlaps = [&](const std::string& other, double overlap) {
      return refusal(index, "overlaps " + other + " by " + rounded(100 * overlap) +
                                " % of the smaller radius (limit " + rounded(100 * limit) +
                                " %); largest_initial_overlap allows more");
    };
    for (const Wall<Dim>& wall : walls_) {
      if (p.held() && !wall.yields()) continue;  // no force moves either
      if (apart(p.material, wall.material)) continue;
      const double distance = wall.foot(p.position).distance;
      if (distance < 0) throw refusal(index, "lies behind wall \"" + wall.name + "\"");
      const double overlap = (p.radius - distance) / p.radius;
      if (overlap > limit) throw overlaps("wall \"" + wall.name + "\"", overlap);
    }
    constexpr int kNone = std::numeric_limits<int>::max();
    int first = kNone;  // of those that it overlaps
    double first_overlap = 0;
    occupied_.for_each_near(p.position, p.radius, [&](int j) {
      const Grain<Dim>& other = placed_.grains[static_cast<std::size_t>(j)];
      const double overlap = (p.radius + other.radius - (p.position - other.position).norm()) /
                             std::min(p.radius, other.radius);
      if (j < first && overlap > limit && !(p.held() && other.held()) &&
          !apart(p.material, other.material)) {
        first = j;
        first_overlap = overlap;
      }
      return true;
    });
    if (first != kNone) throw overlaps(name_of(static_cast<std::size_t>(first)), first_overlap);
    add(grain_like(p), -1);
  }

  /// Grains of another run overlap as they did there; walls may have come nearer since.
  void place_as_it_was(const PlacedGrain<Dim>& p) {
    const std::size_t index = placed_.grains.size();
    for (const Wall<Dim>& wall : walls_) {
      if ((p.held() && !wall.yields()) || apart(p.material, wall.material)) continue;
      const double distance = wall.foot(p.position).distance;
      if (distance < 0) throw refusal(index, "lies behind wall \"" + wall.name + "\"");
      const double overlap = (p.radius - distance) / p.radius;
      if (overlap > scene_.largest_overlap) {
        throw refusal(index, "overlaps wall \"" + wall.name + "\" by " + rounded(100 * overlap) +
                                 " % of its radius (limit " +
                                 rounded(100 * scene_.largest_overlap) +
                                 " %, largest_overlap); move that wall away");
      }
    }
    add(grain_like(p), -1);
  }

  Grain<Dim> grain_like(const PlacedGrain<Dim>& p) const {
    Grain<Dim> grain;
    grain.position = p.position;
    grain.velocity = p.velocity;
    grain.omega = p.spin;
    grain.radius = p.radius;
    grain.pinned = p.pinned;
    grain.driven = p.driven;
    grain.material = p.material;
    grain.mass = scene_.materials[static_cast<std::size_t>(p.material)].density *
                 grain_volume<Dim>(p.radius, scene_.depth);
    return grain;
  }

  bool apart(int a, int b) const {
    return apart_(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  }

  void add(const Grain<Dim>& grain, int group) {
    occupied_.add(static_cast<int>(placed_.grains.size()), grain.position, grain.radius);
    placed_.grains.push_back(grain);
    placed_.group.push_back(group);
    look();
  }

  bool free(const Vec<Dim>& x, double r) const {
    if (!clear_of_walls(walls_, x, r)) return false;
    bool is_free = true;
    occupied_.for_each_near(x, r, [&](int j) {
      const Grain<Dim>& other = placed_.grains[static_cast<std::size_t>(j)];
      const double reach = r + other.radius;
      is_free = (x - other.position).squaredNorm() >= reach * reach;
      return is_free;
    });
    return is_free;
  }

  void fill(std::size_t index) {
    const Fill<Dim>& f = scene_.fills[index];
    // Each group has numbers of its own: a change in one leaves the others alone.
    Random random(scene_.seed + 0x9E3779B97F4A7C15ULL * (index + 1));
    if (f.arrangement == Arrangement::random) {
      fill_at_random(f, static_cast<int>(index), random);
      return;
    }
    const int held = fill_lattice(f, static_cast<int>(index), random);
    if (held == 0) fail(index, "no grain fits into its region");
    if (f.count && held < *f.count) {
      fail(index, "its region held " + std::to_string(held) + " of the " +
                      std::to_string(*f.count) + " grains asked for");
    }
  }

  [[noreturn]] void fail(std::size_t index, const std::string& message) const {
    throw scene_.error("fill[" + std::to_string(index) + "]",
                       "\"" + scene_.fills[index].name + "\": " + message);
  }

  int fill_lattice(const Fill<Dim>& f, int group, Random& random) {
    const double width = 2 * largest(f.radius) * kSpacing;
    const RadiusDraw<Dim> draw(f.radius);
    std::array<std::int64_t, Dim> shape;
    std::array<std::int64_t, Dim> at{};
    for (std::size_t d = 0; d < Dim; ++d) {
      const auto k = static_cast<Eigen::Index>(d);
      // A region given as a multiple of the spacing holds that many, rounding or not.
      shape[d] =
          static_cast<std::int64_t>((f.region.high[k] - f.region.low[k]) / width * (1 + 1e-12));
      if (shape[d] == 0) return 0;
    }
    int held = 0;
    for (bool more = true; more && !(f.count && held == *f.count);) {
      const double r = draw(random);
      Vec<Dim> x;
      for (std::size_t d = 0; d < Dim; ++d) {
        const auto k = static_cast<Eigen::Index>(d);
        const double room = 0.5 * width / kSpacing * (kSpacing - 1);
        x[k] = f.region.low[k] + (static_cast<double>(at[d]) + 0.5) * width +
               random.uniform(-room, room);
      }
      if (free(x, r)) {
        add(grain_from(scene_, f, r, x, random), group);
        ++held;
      }
      more = false;  // the first axis runs fastest, the last one is up
      for (std::size_t d = 0; d < Dim && !more; ++d) {
        more = at[d] + 1 < shape[d];
        at[d] = more ? at[d] + 1 : 0;
      }
    }
    return held;
  }

  void fill_at_random(const Fill<Dim>& f, int group, Random& random) {
    const RadiusDraw<Dim> draw(f.radius);
    std::vector<double> radii(static_cast<std::size_t>(*f.count));
    for (double& r : radii) r = draw(random);
    std::sort(radii.begin(), radii.end(), std::greater<>());
    const std::string asked = refuse_beyond_densest(f, group, radii);
    bool full = false;
    for (const double r : radii) {
      bool found = false;
      double smallest = std::numeric_limits<double>::infinity();
      Vec<Dim> least_bad = Vec<Dim>::Zero();
      int overlapping = 0;  // a place behind a wall is no place
      for (int attempt = 0; attempt < kTries && !found; ++attempt) {
        if (full && overlapping == kTriesWhenFull) break;
        if (attempt % 100 == 99) look();
        Vec<Dim> x;
        for (int d = 0; d < Dim; ++d)
          x[d] = random.uniform(f.region.low[d] + r, f.region.high[d] - r);
        if (!(((x - f.region.low).array() >= r).all() && ((f.region.high - x).array() >= r).all()))
          continue;
        found = free(x, r);
        if (found) add(grain_from(scene_, f, r, x, random), group);
        if (found || !clear_of_walls(walls_, x, r)) continue;
        ++overlapping;
        const double overlap = largest_overlap(x, r);
        if (overlap < smallest) {
          smallest = overlap;
          least_bad = x;
        }
      }
      if (found) continue;
      full = true;
      if (smallest == std::numeric_limits<double>::infinity()) {
        fail(static_cast<std::size_t>(group), "no grain fits into its region");
      }
      add(grain_from(scene_, f, r, least_bad, random), group);
    }
    if (full) make_room(f, group, asked);
  }

  /// Whether a grain was placed at random in the same region.
  bool shares_region(std::size_t grain, const Fill<Dim>& f) const {
    if (placed_.group[grain] < 0) return false;
    const Fill<Dim>& other = scene_.fills[static_cast<std::size_t>(placed_.group[grain])];
    return other.arrangement == Arrangement::random && other.region.low == f.region.low &&
           other.region.high == f.region.high;
  }

  /// @return the solid fraction asked for, in words
  std::string refuse_beyond_densest(const Fill<Dim>& f, int group,
                                    const std::vector<double>& radii) const {
    double solid = 0;
    double least = radii.back();
    double most = radii.front();
    const auto count = [&](double r) {
      solid += grain_volume<Dim>(r);
      least = std::min(least, r);
      most = std::max(most, r);
    };
    for (const double r : radii) count(r);
    for (std::size_t i = 0; i < placed_.grains.size(); ++i) {
      if (shares_region(i, f)) count(placed_.grains[i].radius);
    }
    const double fraction = solid / (f.region.high - f.region.low).prod();
    std::string asked = "a solid fraction of " + three_digits(fraction) + " in its region";
    // Small grains between large ones pass the bound of equal ones.
    const double limit = least == most ? kDensest<Dim> : 1;
    if (fraction > limit) {
      fail(static_cast<std::size_t>(group), asked + "; " + (least == most ? "equal " : "") +
                                                (Dim == 2 ? "discs" : "spheres") +
                                                " reach at most " + three_digits(limit));
    }
    return asked;
  }

  static std::string three_digits(double value) {
    return shortest(std::round(1000 * value) / 1000);
  }

  /// The deepest overlap of a ball with the grains so far, of the smaller radius [-].
  double largest_overlap(const Vec<Dim>& x, double r) const {
    double largest = 0;
    occupied_.for_each_near(x, r, [&](int j) {
      const Grain<Dim>& other = placed_.grains[static_cast<std::size_t>(j)];
      largest = std::max(
          largest, (r + other.radius - (x - other.position).norm()) / std::min(r, other.radius));
      return true;
    });
    return largest;
  }

  /// Pushes apart what was placed at random in the region of a fill.
  void make_room(const Fill<Dim>& f, int group, const std::string& asked) {
    std::vector<std::size_t> chosen;
    std::vector<Grain<Dim>> grains;
    for (std::size_t i = 0; i < placed_.grains.size(); ++i) {
      Grain<Dim> grain = placed_.grains[i];
      const bool near = ((grain.position - f.region.low).array() > -grain.radius).all() &&
                        ((f.region.high - grain.position).array() > -grain.radius).all();
      if (!near) continue;
      grain.driven = false;
      grain.pinned = !shares_region(i, f);
      if (grain.pinned) {
        grain.velocity.setZero();
        grain.omega.setZero();
      }
      chosen.push_back(i);
      grains.push_back(grain);
    }
    std::vector<Wall<Dim>> walls = walls_;
    for (int d = 0; d < Dim; ++d) {
      walls.push_back(Wall<Dim>::half_space("low", f.region.low, Vec<Dim>::Unit(d)));
      walls.push_back(Wall<Dim>::half_space("high", f.region.high, -Vec<Dim>::Unit(d)));
    }
    const double left = detail::push_apart(grains, std::move(walls), kPushes, [&] { look(); });
    if (left > 0) {
      fail(static_cast<std::size_t>(group),
           asked + "; after " + std::to_string(kPushes) + " pushes grains still overlap by " +
               three_digits(100 * left) + " % of the smaller radius (equal " +
               (Dim == 2 ? "discs" : "spheres") + " at random reach about " +
               shortest(kDensestRandom<Dim>) + ")");
    }
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      placed_.grains[chosen[k]].position = grains[k].position;
    }
    occupied_ = Occupied<Dim>(usual_radii(scene_));
    for (std::size_t i = 0; i < placed_.grains.size(); ++i) {
      occupied_.add(static_cast<int>(i), placed_.grains[i].position, placed_.grains[i].radius);
    }
  }

  const Scene<Dim>& scene_;
  const PlacementWatch& watch_;
  std::int64_t asked_ = 0;  // grains, as far as the scene says how many
  MaterialsApart apart_;
  detail::Start<Dim> start_;
  std::vector<Wall<Dim>> walls_;  // where the run begins: a path may begin elsewhere
  std::vector<detail::ListedGrains<Dim>> listed_;  // of each file
  Occupied<Dim> occupied_;
  Placement<Dim> placed_;
};

}  // namespace

template <int Dim>
Placement<Dim> place_grains(const Scene<Dim>& scene, const PlacementWatch& watch) {
  return Placer<Dim>(scene, watch).place();
}

template Placement<2> place_grains<2>(const Scene<2>&, const PlacementWatch&);
template Placement<3> place_grains<3>(const Scene<3>&, const PlacementWatch&);

}  // namespace lagrain
