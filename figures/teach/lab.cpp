// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The functions that teaching pages call. They are plain C functions over three arrays, because
/// JavaScript sees such arrays as they are: a page writes discs into lagrain_input(n), calls a
/// function, and reads what that found from lagrain_reals() and lagrain_ints().
///
/// - A function that can fail returns 0 (where 1 is success), or -1 (where a count is success), or
///   NaN (where a number is). lagrain_error() then says why in a sentence, and what was there
///   before still stands.
/// - Arrays move: a page takes its views of them anew after every call.
/// - Lengths are in metres, the corners of all simplices are numbers of discs, from 0.

#include <lagrain/audit.hpp>
#include <lagrain/check.hpp>
#include <lagrain/cundall_strack.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/integrator.hpp>
#include <lagrain/laguerre2.hpp>
#include <lagrain/law_table.hpp>
#include <lagrain/observe.hpp>
#include <lagrain/predicates2.hpp>
#include <lagrain/predicates3.hpp>
#include <lagrain/random.hpp>
#include <lagrain/restitution.hpp>
#include <lagrain/simulation.hpp>
#include <lagrain/time_step.hpp>
#include <lagrain/touch.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#ifdef __EMSCRIPTEN__
#include <emscripten.h>
#define LAGRAIN_PAGE extern "C" EMSCRIPTEN_KEEPALIVE
#else
#define LAGRAIN_PAGE extern "C"
#endif

using namespace lagrain;

namespace {

/// A page draws and searches all pairs of so many discs within a frame; of more it would stall.
constexpr int kMostDiscs = 2000;
/// Grains keep the slots of their numbers up to 1,024 (GrainStore), so that the neighbourhood knows
/// them by their numbers. A step of so many takes a fifth of a millisecond.
constexpr int kMostGrains = 1000;
/// Places and radii of discs by hand are at most this, so that their squares are far from infinity.
constexpr double kFarthest = 1e9;

std::string error;
std::vector<double> input;
std::vector<double> reals;
std::vector<int> ints;

/// Runs f and returns what it returns. What it throws becomes the sentence of lagrain_error().
template <class R, class F>
R guarded(R failed, F&& f) {
  try {
    error.clear();
    return f();
  } catch (const std::exception& e) {
    error = e.what();
    return failed;
  }
}
/// The same for a function that returns nothing. @returns 1 if all went well
template <class F>
int done(F&& f) {
  return guarded(0, [&] {
    f();
    return 1;
  });
}

/// What a page asked for cannot be had. (A failed LAGRAIN_EXPECTS shows its condition, which says
/// nothing to the reader of a page.)
void expect(bool holds, const std::string& sentence) {
  if (!holds) throw ContractError(sentence);
}
/// A number as a reader would write it.
std::string in_words(double number) {
  if (std::isnan(number)) return "not a number";
  std::string text = std::to_string(number);
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}
std::string in_words(int number) { return std::to_string(number); }

void expect_count(int count, int most, const char* things) {
  expect(count >= 1 && count <= most,
         "there can be 1 to " + in_words(most) + " " + things + " here, not " + in_words(count));
}
void expect_input(std::size_t count) {
  expect(input.size() >= count, "the page gave " + in_words(static_cast<int>(input.size())) +
                                    " numbers where " + in_words(static_cast<int>(count)) +
                                    " are needed");
  for (std::size_t k = 0; k < count; ++k) {
    expect(std::isfinite(input[k]),
           "number " + in_words(static_cast<int>(k)) + " of the input is " + in_words(input[k]));
  }
}

template <class... I>
void give_ints(I... values) {
  ints.insert(ints.end(), {static_cast<int>(values)...});
}
template <class... R>
void give_reals(R... values) {
  reals.insert(reals.end(), {static_cast<double>(values)...});
}
void give_edges(std::span<const EdgeList::Edge> edges) {
  for (const auto& [i, j] : edges) give_ints(i, j);
}
void clear_answer() {
  error.clear();
  reals.clear();
  ints.clear();
}

// ---- Discs by hand -----------------------------------------------------------------------------

/// The weight that a disc gets in T. Theorem 2.1 needs the first; the others show what it is for.
enum class Rule { square, root, radius, zero };

/// A disc as a page gives it.
struct Disc {
  double x, y, r;
};

/// Discs, and T as it was told of them last.
class Discs {
 public:
  Discs() = default;
  Discs(std::vector<Disc> discs, Rule rule) : discs_(std::move(discs)), rule_(rule) {
    for (std::size_t i = 0; i < discs_.size(); ++i) expect_sound(static_cast<int>(i), discs_[i]);
    expect_apart(discs_);
    believed_ = discs_;
    t_.build(places(), weights());
  }

  int size() const { return static_cast<int>(discs_.size()); }
  const Disc& disc(int i) const {
    expect(i >= 0 && i < size(), "there is no disc " + in_words(i) + " among " + in_words(size()));
    return discs_[static_cast<std::size_t>(i)];
  }
  const std::vector<Disc>& all() const { return discs_; }
  /// As T believes them: the same unless it stands still.
  const std::vector<Disc>& believed() const { return believed_; }
  const Triangulation<2>& t() const { return t_; }
  std::span<const EdgeList::Edge> edges() { return t_.edges(); }
  bool still() const { return still_; }

  double weight_of(double r) const {
    switch (rule_) {
      case Rule::root:
        return std::sqrt(r);
      case Rule::radius:
        return r;
      case Rule::zero:
        return 0;
      case Rule::square:
        break;
    }
    return r * r;
  }

  UpdateReport move(int i, const Disc& to) {
    static_cast<void>(disc(i));
    expect_sound(i, to);
    auto moved = discs_;
    moved[static_cast<std::size_t>(i)] = to;
    expect_apart(moved);
    return place(std::move(moved));
  }
  /// The same for a place on the way to a sound one.
  void pass(int i, const Disc& through) {
    auto moved = discs_;
    moved[static_cast<std::size_t>(i)] = through;
    place(std::move(moved));
  }
  UpdateReport move_all(std::vector<Disc> to) {
    expect(to.size() == discs_.size(),
           in_words(static_cast<int>(to.size())) + " places for " + in_words(size()) + " discs");
    for (std::size_t i = 0; i < to.size(); ++i) expect_sound(static_cast<int>(i), to[i]);
    expect_apart(to);
    return place(std::move(to));
  }
  /// T stays as it is while discs move; or it is brought up to date and follows again.
  UpdateReport stand_still(bool on) {
    still_ = on;
    return on ? UpdateReport{} : follow();
  }

 private:
  static void expect_sound(int i, const Disc& disc) {
    const auto fits = [](double number) { return std::abs(number) <= kFarthest; };
    if (fits(disc.x) && fits(disc.y) && fits(disc.r) && disc.r > 0) return;
    const std::string name = "disc " + in_words(i);
    expect(std::isfinite(disc.x) && std::isfinite(disc.y) && std::isfinite(disc.r),
           name + " has a place or radius that is not a number");
    expect(disc.r > 0, name + " has the radius " + in_words(disc.r) + ", which must be positive");
    expect(false, name + " is larger or further away than a thousand million metres");
  }
  static void expect_apart(const std::vector<Disc>& discs) {
    const auto at_first = [&](const Disc& d) {
      return d.x == discs.front().x && d.y == discs.front().y;
    };
    expect(discs.size() < 2 || !std::all_of(discs.begin(), discs.end(), at_first),
           "all " + in_words(static_cast<int>(discs.size())) +
               " discs lie at one point, where there is nothing to triangulate");
  }

  Columns<2> places() const {
    Columns<2> x(2, size());
    for (int i = 0; i < size(); ++i) {
      const Disc& d = discs_[static_cast<std::size_t>(i)];
      x.col(i) << d.x, d.y;
    }
    return x;
  }
  Eigen::VectorXd weights() const {
    Eigen::VectorXd w(size());
    for (int i = 0; i < size(); ++i) w[i] = weight_of(discs_[static_cast<std::size_t>(i)].r);
    return w;
  }
  UpdateReport place(std::vector<Disc> to) {
    discs_ = std::move(to);
    return still_ ? UpdateReport{} : follow();
  }
  UpdateReport follow() {
    std::vector<int> moved;
    for (int i = 0; i < size(); ++i) {
      const Disc &now = discs_[static_cast<std::size_t>(i)],
                 &then = believed_[static_cast<std::size_t>(i)];
      if (now.x != then.x || now.y != then.y || now.r != then.r) moved.push_back(i);
    }
    believed_ = discs_;
    return t_.move(moved, places(), weights());
  }

  std::vector<Disc> discs_, believed_;
  Rule rule_ = Rule::square;
  bool still_ = false;
  Triangulation<2> t_;
};

Discs discs;

std::vector<Disc> discs_of_input(int n) {
  expect_count(n, kMostDiscs, "discs");
  expect(input.size() >= 3 * static_cast<std::size_t>(n),
         "the page gave fewer than three numbers for each disc");
  std::vector<Disc> list;
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    list.push_back({input[3 * i], input[3 * i + 1], input[3 * i + 2]});
  }
  return list;
}

/// What T consists of.
struct Moment {
  std::vector<EdgeList::Edge> edges;
  std::vector<int> hidden;
};

/// Finds what happens to T while one disc moves along a straight line. T is unique, so what happens
/// between two places is what differs between the T of the one and of the other; the way is halved
/// until each piece holds one event. So events come in their order in time, in which flips are not
/// made. They are found on a copy.
class EventSearch {
 public:
  EventSearch(const Discs& from, int i, const Disc& to)
      : discs_(from), i_(i), from_(from.disc(i)), to_(to) {
    Moment before = at(0);
    for (int k = 0; k < kPieces; ++k) {
      const double begin = static_cast<double>(k) / kPieces;
      const double end = static_cast<double>(k + 1) / kPieces;
      Moment after = at(end);
      search(begin, before, end, after, kDeepest);
      before = std::move(after);
    }
  }
  int count() const { return count_; }

 private:
  /// What goes and comes back within such a part of the way is not seen. With twice as many pieces
  /// a drag takes twice as long where nothing happens.
  static constexpr int kPieces = 64;
  /// The way is halved so often at most. Events that are still together then are one: many edges of
  /// a lattice change at one instant.
  static constexpr int kDeepest = 40;
  /// An instant is known to this part of the way.
  static constexpr double kInstant = 1e-6;

  Moment at(double t) {
    const auto between = [&](double a, double b) { return t == 1 ? b : a + t * (b - a); };
    discs_.pass(i_, {between(from_.x, to_.x), between(from_.y, to_.y), between(from_.r, to_.r)});
    const auto edges = discs_.edges();
    const auto hidden = discs_.t().hidden();
    return {{edges.begin(), edges.end()}, {hidden.begin(), hidden.end()}};
  }

  void search(double begin, const Moment& before, double end, const Moment& after, int depth) {
    std::vector<EdgeList::Edge> gone, made;
    std::set_difference(before.edges.begin(), before.edges.end(), after.edges.begin(),
                        after.edges.end(), std::back_inserter(gone));
    std::set_difference(after.edges.begin(), after.edges.end(), before.edges.begin(),
                        before.edges.end(), std::back_inserter(made));
    if (gone.empty() && made.empty() && before.hidden == after.hidden) return;
    // A flip changes one edge for one; three go with a site that hides, and come with it; at the
    // hull one comes or goes.
    const bool one = std::max(gone.size(), made.size()) == 1 ||
                     (gone.size() + made.size() == 3 && (gone.empty() || made.empty()));
    if (depth == 0 || (one && end - begin <= kInstant)) {
      reals.push_back(0.5 * (begin + end));
      give_ints(gone.size(), made.size());
      give_edges(gone);
      give_edges(made);
      ++count_;
      return;
    }
    const double middle = 0.5 * (begin + end);
    const Moment halfway = at(middle);
    search(begin, before, middle, halfway, depth - 1);
    search(middle, halfway, end, after, depth - 1);
  }

  Discs discs_;
  int i_;
  Disc from_, to_;
  int count_ = 0;
};

// ---- Signs -------------------------------------------------------------------------------------

/// The sites of the input, each x, y, w.
template <std::size_t N>
std::array<Site2, N> sites_of_input() {
  expect_input(3 * N);
  std::array<Site2, N> sites;
  for (std::size_t k = 0; k < N; ++k) sites[k] = {input[3 * k], input[3 * k + 1], input[3 * k + 2]};
  return sites;
}

int sign_of(double number) { return (number > 0) - (number < 0); }

/// The sign of the orientation as one who does not know better computes it.
int rounded_orientation(const Site2& a, const Site2& b, const Site2& c) {
  return sign_of((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
}
/// The same for the power test.
int rounded_power_side(const Site2& a, const Site2& b, const Site2& c, const Site2& d) {
  const auto height = [&](const Site2& s) {
    return (s.x - d.x) * (s.x - d.x) + (s.y - d.y) * (s.y - d.y) - (s.w - d.w);
  };
  const auto bracket = [&](const Site2& p, const Site2& q) {
    return (p.x - d.x) * (q.y - d.y) - (p.y - d.y) * (q.x - d.x);
  };
  return sign_of(height(a) * bracket(b, c) + height(b) * bracket(c, a) + height(c) * bracket(a, b));
}

/// The distance of two doubles next to each other where p is.
double ulp_at(double x, double y) {
  int exponent = 0;
  std::frexp(std::max(std::abs(x), std::abs(y)), &exponent);
  return std::ldexp(1.0, exponent - 53);
}

/// Signs at n x n places around (x, y), one ulp apart: first those of doubles, then the exact ones,
/// each as 0, 1 or 2. @returns how many differ
template <class Rounded, class Exact>
int map_signs(int n, double x, double y, Rounded&& rounded, Exact&& exact) {
  constexpr int kLargestMap = 512;
  expect(n >= 1 && n <= kLargestMap, "a map has 1 to " + in_words(kLargestMap) + " signs a side");
  const double ulp = ulp_at(x, y);
  const auto count = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  ints.assign(2 * count, 0);
  int differ = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const auto column = static_cast<double>(k % static_cast<std::size_t>(n));
    const auto row = static_cast<double>(k / static_cast<std::size_t>(n));
    const double px = x + column * ulp, py = y + row * ulp;
    ints[k] = rounded(px, py) + 1;
    ints[count + k] = exact(px, py) + 1;
    differ += ints[k] != ints[count + k];
  }
  return differ;
}

// ---- Grains ------------------------------------------------------------------------------------

using Law = CundallStrack<LinearSpring>;
using Lazy = TriangulationNeighbourhood<2>;
using Sim = Simulation<2, Law, VelocityVerlet, Lazy>;

/// The scenes that a page can start.
enum class Kind { pour, bed, bounce, gas };

constexpr double kGravity = 9.81;      // [m/s^2]
constexpr double kDensity = 2500;      // [kg/m^3]
constexpr double kDepth = 0.05;        // of the discs [m]
constexpr double kWidth = 1;           // of the box [m]
constexpr double kMeanRadius = 0.025;  // of 200 grains or fewer [m]
constexpr int kWhole = 200;            // more grains are smaller, so that they fit into the box
constexpr double kBallRadius = 0.05;   // of the bouncing disc [m]
constexpr double kBallHeight = 1;      // of its lowest point above the floor at the start [m]

/// A straight wall as it is drawn.
struct Line {
  double x0, y0, x1, y1;
};

/// What a scene is made of.
struct Scene {
  std::vector<Grain<2>> grains;
  std::vector<Wall<2>> walls;
  std::vector<Line> lines;
  Vec<2> gravity{0, -kGravity};
  double stiffness = 2e5;   ///< an impact after 2 m of fall has an overlap of 0.2 r [N/m]
  double step_share = 0.5;  ///< of the largest safe time step, a tenth of the shortest contact

  void add_half_space(const char* name, const Line& line, const Vec<2>& normal) {
    walls.push_back(Wall<2>::half_space(name, {line.x0, line.y0}, normal));
    lines.push_back(line);
  }
  void add_segment(const char* name, const Line& line) {
    walls.push_back(Wall<2>::segment(name, {line.x0, line.y0}, {line.x1, line.y1}));
    lines.push_back(line);
  }
  void add_box(double height) {
    add_half_space("floor", {0, 0, kWidth, 0}, {0, 1});
    add_half_space("left", {0, 0, 0, height}, {1, 0});
    add_half_space("right", {kWidth, 0, kWidth, height}, {-1, 0});
  }
  Grain<2>& add_grain(double radius, const Vec<2>& place) {
    Grain<2>& grain = grains.emplace_back();
    grain.radius = radius;
    grain.mass = kDensity * grain_volume<2>(radius, kDepth);
    grain.position = place;
    return grain;
  }
  /// n grains on a loose lattice whose lowest row is at a height [m].
  void add_lattice(int n, double height, Random& random) {
    const double mean = kMeanRadius * std::sqrt(kWhole / std::max<double>(kWhole, n));
    const double pitch = 3.2 * mean;
    const int columns = static_cast<int>(kWidth / pitch);
    const double across = kWidth / columns;
    for (int i = 0; i < n; ++i) {
      const double radius = mean * random.uniform(0.68, 1.32);
      const double aside = 0.1 * random.uniform(-1, 1);
      add_grain(radius, {(i % columns + 0.5 + aside) * across, height + pitch * (i / columns)});
    }
  }
};

Scene scene_of(Kind kind, int n, Random& random) {
  Scene scene;
  switch (kind) {
    case Kind::pour:
      scene.add_box(2.5);
      scene.add_segment("left lip", {0, 1.05, 0.4, 0.72});
      scene.add_segment("right lip", {kWidth, 1.05, 0.6, 0.72});
      scene.add_lattice(n, 1.15, random);
      break;
    case Kind::bed:
      scene.add_box(2.5);
      scene.add_lattice(n, 0.04, random);
      break;
    case Kind::bounce:
      // Its heights are compared with a closed form, which knows no overlap.
      scene.stiffness = 2e7;
      scene.step_share = 0.2;
      scene.add_box(1.5);
      scene.add_grain(kBallRadius, {0.5 * kWidth, kBallRadius + kBallHeight});
      break;
    case Kind::gas: {
      scene.add_box(kWidth);
      scene.add_half_space("lid", {0, kWidth, kWidth, kWidth}, {0, -1});
      scene.gravity.setZero();
      const int side = static_cast<int>(std::ceil(std::sqrt(n)));
      const double pitch = kWidth / side;
      for (int i = 0; i < n; ++i) {
        const Vec<2> place((i % side + 0.5) * pitch, (i / side + 0.5) * pitch);
        scene.add_grain(std::min(kMeanRadius, 0.25 * pitch) * random.uniform(0.68, 1.32), place)
            .velocity = {random.uniform(-1, 1), random.uniform(-1, 1)};
      }
      break;
    }
  }
  return scene;
}

/// A simulation and what a page shows of it.
class Run {
 public:
  Run(Scene scene, const Law& law, const Laziness& laziness)
      : lines_(std::move(scene.lines)), sim_(make(scene, law, laziness)), start_(ledger()) {
    angle_.setZero(sim_.radii().size());
  }

  const Sim& sim() const { return sim_; }
  const std::vector<Line>& lines() const { return lines_; }
  double angle(int i) const { return angle_[i]; }
  const ContactAudit<2>& audit() {
    audit_.check(sim_.grains().position, sim_.radii(), sim_.near_pairs());
    return audit_;
  }
  Ledger ledger() const { return energy_ledger(sim_); }
  double unaccounted() const { return residual(ledger(), start_); }

  void step(int count) {
    expect(count >= 0 && count <= kMostSteps,
           "a call makes at most " + in_words(kMostSteps) + " steps, not " + in_words(count));
    expect(broken_.empty(), "the run has broken off: " + broken_);
    const Eigen::VectorXd before = sim_.grains().omega.row(0);
    try {
      sim_.step(count);
    } catch (const std::exception& e) {
      broken_ = e.what();
      throw;
    }
    // Only for drawing: spins hardly change within a frame.
    angle_ += 0.5 * count * sim_.setting().time_step *
              (before + Eigen::VectorXd(sim_.grains().omega.row(0)));
  }
  void set_gravity(const Vec<2>& g) { sim_.set_gravity(g); }

 private:
  static constexpr int kMostSteps = 100000;

  static Sim make(Scene& scene, const Law& law, const Laziness& laziness) {
    auto grains = make_grains<2, Law::needs>(scene.grains);
    const LawTable<Law> laws(law);
    const double safe = time_scales(grains, laws, scene.walls).safe_step;
    Setting<2> setting;
    setting.gravity = scene.gravity;
    setting.time_step = scene.step_share * safe;
    return Sim(std::move(grains), laws, std::move(scene.walls), setting, Lazy(laziness));
  }

  std::vector<Line> lines_;
  Sim sim_;
  Ledger start_;
  Eigen::VectorXd angle_;
  ContactAudit<2> audit_;
  std::string broken_;
};

/// The grains of a scene come to rest: what a page can wait for, about a second of work.
void settle(Scene& scene, const Law& law) {
  constexpr double kGrainSteps = 4e6;
  Law lossy = law;
  lossy.normal.damping_ratio = damping_ratio_for(0.1);
  Run run(scene, lossy, {});
  run.step(
      static_cast<int>(std::min(40000.0, kGrainSteps / static_cast<double>(scene.grains.size()))));
  for (std::size_t i = 0; i < scene.grains.size(); ++i) {
    scene.grains[i].position = run.sim().grains().position.col(static_cast<int>(i));
  }
}

Laziness laziness;
std::unique_ptr<Run> run;

Run& running() {
  expect(run != nullptr, "no grains have been started");
  return *run;
}

/// FNV-1a over the bytes of numbers.
class Hash {
 public:
  void add(double number) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    for (int k = 0; k < 64; k += 8) {
      value_ ^= bits >> k & 0xff;
      value_ *= 1099511628211U;
    }
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037U;
};

// ---- Precision ---------------------------------------------------------------------------------

constexpr std::array kIntegratorNames{SymplecticEuler::kName, VelocityVerlet::kName,
                                      ForestRuth::kName};

/// What an impact of two equal discs, head-on, got wrong.
struct ImpactErrors {
  double speed;     ///< of the speed afterwards [-]
  double duration;  ///< of the time in touch [-]
};

/// Two discs of radius and mass 1 meet through springs of stiffness 1; the linear law does not know
/// how fast. This is a simulation's loop for one pair that keeps to the x axis, and gives its bits.
/// @param phase  of a step: by how much later they touch [-]
template <class Motion>
ImpactErrors impact_errors(double steps_per_contact, double restitution, double phase) {
  constexpr double kSpeed = 0.1;  // of each
  const LinearSpring law = LinearSpring::with_restitution(1, restitution);
  expect(!Motion::kConservativeOnly || law.conservative(),
         std::string(Motion::kName) + " is for contacts that lose nothing: restitution 1");
  const double contact = law.contact_time(0.5, 0.5);
  const double dt = contact / steps_per_contact;
  const double flight = dt * (1 + phase);

  using Half = Body<2, LinearSpring::needs>;
  std::array<Half, 2> pair{Half{{-1 - kSpeed * flight, 0}, {kSpeed, 0}, 1, 1, {}},
                           Half{{1 + kSpeed * flight, 0}, {-kSpeed, 0}, 1, 1, {}}};
  std::array<Vec<2>, 2> now{Vec<2>::Zero(), Vec<2>::Zero()}, before = now;
  const int steps = static_cast<int>(std::ceil(1.5 * steps_per_contact)) + 3;
  for (int step = 0; step < steps; ++step) {
    for (int k = 0; k < Motion::kEvaluations; ++k) {
      for (std::size_t i = 0; i < 2; ++i) {
        Motion::advance(k, pair[i].position, pair[i].velocity, now[i], dt);
      }
      before = now;
      now = {Vec<2>::Zero(), Vec<2>::Zero()};
      const auto [touching, touch] = touch_of(pair[0], pair[1]);
      if (touching) {
        NoMemory memory;
        now[0] = law.respond(touch, memory, dt).force;
        now[1] = -now[0];
      }
    }
    for (std::size_t i = 0; i < 2; ++i) {
      Motion::finish(pair[i].position, pair[i].velocity, now[i], before[i], dt);
    }
  }
  const double apart = pair[1].velocity[0] - pair[0].velocity[0];
  const double way = pair[1].position[0] - pair[0].position[0] - 2;
  expect(apart > 0 && way > 0, "the step is so long that the impact does not end");
  // The force ends at an overlap of 2 zeta / omega0 times the speed, through which they fly freely.
  const double expected = contact + 2 * law.damping_ratio * law.natural_time(0.5, 0.5);
  const double lasted = steps * dt - way / apart - flight;
  return {apart / (2 * kSpeed * restitution) - 1, lasted / expected - 1};
}

// ---- Space -------------------------------------------------------------------------------------

Triangulation<3> space;

/// The sites of the input, each x, y, z, w.
template <std::size_t N>
std::array<Site3, N> sites_in_space() {
  expect_input(4 * N);
  std::array<Site3, N> sites;
  for (std::size_t k = 0; k < N; ++k) {
    sites[k] = {input[4 * k], input[4 * k + 1], input[4 * k + 2], input[4 * k + 3]};
  }
  return sites;
}

}  // namespace

// ---- Memory ------------------------------------------------------------------------------------

/// The sentence of what failed last; empty after a success.
LAGRAIN_PAGE const char* lagrain_error() { return error.c_str(); }
LAGRAIN_PAGE const double* lagrain_reals() { return reals.data(); }
LAGRAIN_PAGE int lagrain_real_count() { return static_cast<int>(reals.size()); }
LAGRAIN_PAGE const int* lagrain_ints() { return ints.data(); }
LAGRAIN_PAGE int lagrain_int_count() { return static_cast<int>(ints.size()); }
/// Room for n numbers from the page; null for less than 1 or too many.
LAGRAIN_PAGE double* lagrain_input(int n) {
  return guarded(static_cast<double*>(nullptr), [&] {
    constexpr int kMost = 1 << 20;
    expect(n >= 1 && n <= kMost, "no room for " + in_words(n) + " numbers");
    input.assign(static_cast<std::size_t>(n), 0);
    return input.data();
  });
}

// ---- Discs by hand -----------------------------------------------------------------------------

/// Forgets all discs and builds T for others, which it follows.
/// @param n     discs, at most 2,000; input: x, y, r of each
/// @param rule  of the weights: 0 r^2, 1 sqrt r, 2 r, 3 zero
LAGRAIN_PAGE int discs_build(int n, int rule) {
  return done([&] {
    expect(rule >= 0 && rule <= 3, "there is no rule " + in_words(rule) + " for weights");
    discs = Discs(discs_of_input(n), static_cast<Rule>(rule));
  });
}
/// One disc moves, or changes its radius.
LAGRAIN_PAGE int discs_move(int i, double x, double y, double r) {
  return done([&] { discs.move(i, {x, y, r}); });
}
/// All discs move. Input: x, y, r of each. @returns flips, or -1
LAGRAIN_PAGE int discs_move_all(int n) {
  return guarded(-1, [&] { return static_cast<int>(discs.move_all(discs_of_input(n)).flips); });
}
/// One disc moves along a straight line, and T with it.
/// Reals: the instant of each event in [0, 1]. Ints: for each event how many edges go and come,
/// then the ends of those that go, then of those that come. If T stands still nothing happens.
/// @returns the number of events, or -1
LAGRAIN_PAGE int discs_events(int i, double x, double y, double r) {
  return guarded(-1, [&] {
    clear_answer();
    Discs moved = discs;
    moved.move(i, {x, y, r});
    const int count = discs.still() ? 0 : EventSearch(discs, i, {x, y, r}).count();
    discs = std::move(moved);
    return count;
  });
}
LAGRAIN_PAGE int discs_count() { return discs.size(); }
/// Ints: i, j of each edge of T, sorted.
LAGRAIN_PAGE int discs_edges() {
  clear_answer();
  give_edges(discs.edges());
  return static_cast<int>(ints.size() / 2);
}
/// Ints: three corners of each triangle of T, counter-clockwise.
LAGRAIN_PAGE int discs_triangles() {
  clear_answer();
  discs.t().for_each_triangle([](int a, int b, int c) { give_ints(a, b, c); });
  return static_cast<int>(ints.size() / 3);
}
/// Ints: the discs whose cell is empty.
LAGRAIN_PAGE int discs_hidden() {
  clear_answer();
  ints.assign(discs.t().hidden().begin(), discs.t().hidden().end());
  return static_cast<int>(ints.size());
}
/// Ints: i, j of each pair that touches, found from nothing, then 1 if T has the edge, else 0.
LAGRAIN_PAGE int discs_contacts() {
  clear_answer();
  const auto edges = discs.edges();
  const std::vector<Disc>& all = discs.all();
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      const double dx = all[i].x - all[j].x, dy = all[i].y - all[j].y, reach = all[i].r + all[j].r;
      if (dx * dx + dy * dy > reach * reach) continue;
      const EdgeList::Edge pair{static_cast<int>(i), static_cast<int>(j)};
      give_ints(i, j, std::binary_search(edges.begin(), edges.end(), pair));
    }
  }
  return static_cast<int>(ints.size() / 3);
}
/// The cells that T believes in, cut to a box. Ints: the number of corners of each, 0 for a hidden
/// disc. Reals: x, y of all corners, one cell after the other, counter-clockwise.
LAGRAIN_PAGE int discs_cells(double x0, double y0, double x1, double y1) {
  return done([&] {
    expect(std::isfinite(x0 + y0 + x1 + y1) && x0 < x1 && y0 < y1, "the box of the cells is empty");
    clear_answer();
    const Eigen::AlignedBox2d box(Vec<2>(x0, y0), Vec<2>(x1, y1));
    for (int i = 0; i < discs.size(); ++i) {
      const Columns<2> cell = laguerre_cell(discs.t(), i, box);
      give_ints(cell.cols());
      reals.insert(reals.end(), cell.data(), cell.data() + cell.size());
    }
  });
}
/// @returns the number of defects that an exact check of T finds: 0, or lagrain has a bug
LAGRAIN_PAGE int discs_audit() {
  return guarded(-1, [] {
    const auto defects = discs.t().audit();
    if (!defects.empty()) error = defects.front().sentence;
    return static_cast<int>(defects.size());
  });
}
/// On: T stays as it is, and discs alone move. Off: T is brought up to date.
/// @returns flips, or -1
LAGRAIN_PAGE int discs_stand_still(int on) {
  return guarded(-1, [&] { return static_cast<int>(discs.stand_still(on != 0).flips); });
}
/// Reals: x, y, r of each disc as T believes them.
LAGRAIN_PAGE int discs_believed() {
  clear_answer();
  for (const auto& [x, y, r] : discs.believed()) give_reals(x, y, r);
  return discs.size();
}
/// The circle orthogonal to three discs, whose power to the three is the same, as T believes them.
/// Reals: its centre, and its squared radius, which may be negative [m^2].
LAGRAIN_PAGE int discs_circle(int a, int b, int c) {
  return done([&] {
    for (const int i : {a, b, c}) static_cast<void>(discs.disc(i));
    const auto& t = discs.t();
    expect(orientation({t.site(a)[0], t.site(a)[1], 0}, {t.site(b)[0], t.site(b)[1], 0},
                       {t.site(c)[0], t.site(c)[1], 0}) != 0,
           "three centres on a line have no orthogonal circle");
    const Vec<2> p = t.site(b) - t.site(a), q = t.site(c) - t.site(a);
    const double hp = 0.5 * (p.squaredNorm() - t.weight(b) + t.weight(a));
    const double hq = 0.5 * (q.squaredNorm() - t.weight(c) + t.weight(a));
    const double area = p[0] * q[1] - p[1] * q[0];
    const Vec<2> arm((hp * q[1] - hq * p[1]) / area, (p[0] * hq - q[0] * hp) / area);
    const Vec<2> centre = t.site(a) + arm;
    clear_answer();
    give_reals(centre[0], centre[1], arm.squaredNorm() - t.weight(a));
  });
}
/// @returns the power of a point to a disc as it is now [m^2], by the rule of the weights; or NaN
LAGRAIN_PAGE double discs_power(int i, double x, double y) {
  return guarded(std::numeric_limits<double>::quiet_NaN(), [&] {
    const Disc& d = discs.disc(i);
    return (x - d.x) * (x - d.x) + (y - d.y) * (y - d.y) - discs.weight_of(d.r);
  });
}

// ---- Signs -------------------------------------------------------------------------------------

/// @returns 1 for a left turn a, b, c, 0 on a line, -1 for a right turn, exactly; -2: failed
LAGRAIN_PAGE int sign_orientation(double ax, double ay, double bx, double by, double cx,
                                  double cy) {
  return guarded(-2, [&] {
    expect(std::isfinite(ax + ay + bx + by + cx + cy), "a coordinate is not a number");
    return orientation({ax, ay, 0}, {bx, by, 0}, {cx, cy, 0});
  });
}
/// Input: x, y, w of a, b, c, d. @returns 1 if d is in conflict with the triangle a, b, c, however
/// that turns, 0 on a tie, else -1, exactly; -2: failed
LAGRAIN_PAGE int sign_power() {
  return guarded(-2, [] {
    const auto [a, b, c, d] = sites_of_input<4>();
    const int turn = orientation(a, b, c);
    expect(turn != 0, "the corners of the triangle lie on a line");
    return turn * power_side(a, b, c, d);
  });
}
/// The signs of orientation(p, q, r) for n x n places p, to the right and up from the given one by
/// single ulps of it. After Kettner, Mehlhorn, Pion, Schirra & Yap, Comput. Geom. 40 (2008) 61.
/// Ints: n n signs of doubles, row by row from below, each 0, 1 or 2, then as many exact ones.
/// @returns how many of the doubles are wrong, or -1
LAGRAIN_PAGE int sign_map(int n, double px, double py, double qx, double qy, double rx, double ry) {
  return guarded(-1, [&] {
    expect(std::isfinite(px + py + qx + qy + rx + ry), "a coordinate is not a number");
    clear_answer();
    const Site2 q{qx, qy, 0}, r{rx, ry, 0};
    return map_signs(
        n, px, py,
        [&](double x, double y) {
          return rounded_orientation({x, y, 0}, q, r);
        },
        [&](double x, double y) {
          return orientation({x, y, 0}, q, r);
        });
  });
}
/// The same for the power test. Input: x, y, w of a, b, c, counter-clockwise, and of the moving d.
LAGRAIN_PAGE int sign_map_power(int n) {
  return guarded(-1, [&] {
    const auto [a, b, c, d] = sites_of_input<4>();
    expect(orientation(a, b, c) > 0, "the corners of the triangle do not go counter-clockwise");
    clear_answer();
    // C++20 does not let lambdas capture structured bindings by reference everywhere.
    const Site2 sites[] = {a, b, c, d};
    return map_signs(
        n, d.x, d.y,
        [&](double x, double y) {
          return rounded_power_side(sites[0], sites[1], sites[2], {x, y, sites[3].w});
        },
        [&](double x, double y) {
          return power_side(sites[0], sites[1], sites[2], {x, y, sites[3].w});
        });
  });
}

// ---- Grains ------------------------------------------------------------------------------------

/// Starts a scene in a box 1 m wide.
/// @param kind         0: a pour through a funnel; 1: a bed at rest; 2: one disc of radius 0.05 m
///                     that bounces, from 1 m above the floor; 3: a gas in a closed box
/// @param n            grains, at most 1,000; not read by kind 2
/// @param restitution  in [0.05, 1]
LAGRAIN_PAGE int grains_start(int kind, int n, int seed, double friction, double restitution) {
  return done([&] {
    expect(kind >= 0 && kind <= 3, "there is no scene " + in_words(kind));
    expect_count(n, kMostGrains, "grains");
    expect(friction >= 0 && friction <= 10,
           "friction is a number from 0 to 10, not " + in_words(friction));
    expect(restitution >= 0.05 && restitution <= 1,
           "restitution is a number from 0.05 to 1, not " + in_words(restitution));
    Random random(static_cast<std::uint64_t>(seed));
    Scene scene = scene_of(static_cast<Kind>(kind), n, random);
    const Law law{.normal = LinearSpring::with_restitution(scene.stiffness, restitution),
                  .friction = friction};
    if (static_cast<Kind>(kind) == Kind::bed) settle(scene, law);
    run = std::make_unique<Run>(std::move(scene), law, laziness);
  });
}
LAGRAIN_PAGE int grains_step(int count) {
  return done([&] { running().step(count); });
}
/// [s], or NaN
LAGRAIN_PAGE double grains_time() {
  return guarded(std::numeric_limits<double>::quiet_NaN(), [] { return running().sim().time(); });
}
/// [s], or NaN
LAGRAIN_PAGE double grains_time_step() {
  return guarded(std::numeric_limits<double>::quiet_NaN(),
                 [] { return running().sim().setting().time_step; });
}
/// Gravity is this from now on [m/s^2].
LAGRAIN_PAGE int grains_gravity(double x, double y) {
  return done([&] {
    expect(std::isfinite(x) && std::isfinite(y), "gravity is not a number");
    running().set_gravity({x, y});
  });
}
LAGRAIN_PAGE int grains_count() { return run ? static_cast<int>(run->sim().radii().size()) : 0; }
/// Reals: x, y, r [m], angle [rad] of each grain. @returns grains, or -1
LAGRAIN_PAGE int grains_places() {
  return guarded(-1, [] {
    const Run& r = running();
    const auto& g = r.sim().grains();
    clear_answer();
    for (int i = 0; i < g.size(); ++i) {
      give_reals(g.position(0, i), g.position(1, i), g.radius[i], r.angle(i));
    }
    return g.size();
  });
}
/// Ints: i, j of each contact, j = -1 for a wall. Reals: x, y of the one centre and of the other
/// (at a wall, of the foot) [m], and the normal force [N]. @returns contacts, or -1
LAGRAIN_PAGE int grains_contacts() {
  return guarded(-1, [] {
    const Sim& sim = running().sim();
    const auto& g = sim.grains();
    clear_answer();
    sim.for_each_contact([&](Pair p, const auto& touch, const auto& response, const auto&) {
      give_ints(p.i, p.j);
      give_reals(g.position(0, p.i), g.position(1, p.i), g.position(0, p.j), g.position(1, p.j),
                 std::abs(response.force.dot(touch.normal)));
    });
    sim.for_each_wall_contact(
        [&](WallPair p, const auto& touch, const auto& response, const auto&) {
          const Vec<2> foot = g.position.col(p.i) - (g.radius[p.i] - touch.overlap) * touch.normal;
          give_ints(p.i, -1);
          give_reals(g.position(0, p.i), g.position(1, p.i), foot[0], foot[1],
                     std::abs(response.force.dot(touch.normal)));
        });
    return static_cast<int>(ints.size() / 2);
  });
}
/// Reals: x0, y0, x1, y1 of each straight wall [m]. @returns walls, or -1
LAGRAIN_PAGE int grains_walls() {
  return guarded(-1, [] {
    clear_answer();
    for (const auto& [x0, y0, x1, y1] : running().lines()) give_reals(x0, y0, x1, y1);
    return static_cast<int>(running().lines().size());
  });
}
/// The lazy T. Ints: i, j of each edge. Reals: x, y where T believes each grain to be, its radius
/// and its skin [m]. @returns edges, or -1
LAGRAIN_PAGE int grains_triangulation() {
  return guarded(-1, [] {
    const Sim& sim = running().sim();
    const Lazy& lazy = sim.neighbourhood();
    clear_answer();
    lazy.triangulation().for_each_edge([](int i, int j) { give_ints(i, j); });
    for (int i = 0; i < grains_count(); ++i) {
      const Vec<2> place = lazy.reference(i);
      give_reals(place[0], place[1], sim.radii()[i], lazy.skin(i));
    }
    return static_cast<int>(ints.size() / 2);
  });
}
/// Ints: the grains around which pairs are searched by brute force, because an edge fails the
/// certificate. @returns how many, or -1
LAGRAIN_PAGE int grains_uncertain() {
  return guarded(-1, [] {
    const auto uncertain = running().sim().neighbourhood().uncertain();
    clear_answer();
    ints.assign(uncertain.begin(), uncertain.end());
    return static_cast<int>(ints.size());
  });
}
/// What holds from the next start on. Off: T is built once and stands still, and may miss contacts.
LAGRAIN_PAGE int grains_follow(int on) {
  return done([&] { laziness.follow = on != 0; });
}
/// From the next start on skins are this times those that pass the certificate; 1.3 as a rule.
LAGRAIN_PAGE int grains_skin(double factor) {
  return done([&] {
    expect(factor > 0 && factor <= 10, "skins are 0 to 10 times, not " + in_words(factor));
    laziness.skin = factor;
  });
}
/// From the next start on: whether edges are certified after every update.
LAGRAIN_PAGE int grains_certify(int on) {
  return done([&] { laziness.certify = on != 0; });
}
/// From the next start on: whether T may be built anew with wide skins where many grains fly.
LAGRAIN_PAGE int grains_leap(int on) {
  return done([&] { laziness.leap = on != 0; });
}
/// Reals: energies [J]: kinetic, gravity, elastic, taken by dashpots, by friction, put in by walls,
/// by who turns gravity, and what the ledger cannot account for; then contacts between grains, the
/// mean number of contacts of a grain, flips, references moved, updates of T, leaps; and contacts
/// audited and missed, by a search from nothing at every call of this function. @returns 16 or -1
LAGRAIN_PAGE int grains_report() {
  return guarded(-1, [] {
    Run& r = running();
    const Ledger ledger = r.ledger();
    const ContactStatistics contacts = contact_statistics(r.sim());
    const TriangulationCost& cost = r.sim().neighbourhood().cost();
    const ContactAudit<2>& audit = r.audit();
    clear_answer();
    give_reals(ledger.kinetic, ledger.gravity, ledger.elastic, ledger.dashpot, ledger.friction,
               ledger.wall_work, ledger.gravity_work, r.unaccounted(), contacts.contacts,
               contacts.coordination, cost.ladder.flips, cost.moved, cost.updates, cost.leaps,
               audit.contacts(), audit.missed());
    return static_cast<int>(reals.size());
  });
}
/// Ints: the upper and the lower half of a hash of all places and radii: two machines agree on
/// every bit if they agree on this.
LAGRAIN_PAGE int grains_hash() {
  return done([] {
    const auto& g = running().sim().grains();
    Hash hash;
    for (int i = 0; i < g.size(); ++i) {
      hash.add(g.position(0, i));
      hash.add(g.position(1, i));
      hash.add(g.radius[i]);
    }
    clear_answer();
    give_ints(static_cast<std::uint32_t>(hash.value() >> 32),
              static_cast<std::uint32_t>(hash.value()));
  });
}

// ---- Precision ---------------------------------------------------------------------------------

LAGRAIN_PAGE int impact_integrators() { return static_cast<int>(kIntegratorNames.size()); }
/// The name of an integrator; empty if there is none.
LAGRAIN_PAGE const char* impact_integrator_name(int integrator) {
  if (integrator < 0 || integrator >= impact_integrators()) return "";
  return kIntegratorNames[static_cast<std::size_t>(integrator)];
}
/// Two equal discs meet head-on, through a linear spring and dashpot, which has a closed form.
/// Reals: the error of the speed afterwards and of the duration, of what they should be, as root
/// mean squares over places of the first touch within a step; and force evaluations to a contact.
/// @param steps_per_contact  at least 3; a simulation refuses less than 10
/// @param restitution        in (0, 1]; 1 for integrators of conservative scenes
LAGRAIN_PAGE int impact(int integrator, double steps_per_contact, double restitution) {
  return done([&] {
    constexpr int kPhases = 16;
    constexpr double kMostSteps = 1e5;
    expect(integrator >= 0 && integrator < impact_integrators(),
           "there is no integrator " + in_words(integrator));
    expect(restitution > 0 && restitution <= 1,
           "restitution is above 0 and at most 1, not " + in_words(restitution));
    expect(steps_per_contact >= 3 && steps_per_contact <= kMostSteps,
           "a contact takes 3 to 100000 steps here, not " + in_words(steps_per_contact));
    const auto measure = [&]<class Motion>(Motion) {
      double speed = 0, duration = 0;
      for (int k = 0; k < kPhases; ++k) {
        // A contact of a whole number of steps ends as it began, and errors cancel: steps differ.
        const double detuned = steps_per_contact * (1 + 0.1 * k / kPhases);
        const auto errors = impact_errors<Motion>(detuned, restitution, (k + 0.5) / kPhases);
        speed += errors.speed * errors.speed / kPhases;
        duration += errors.duration * errors.duration / kPhases;
      }
      clear_answer();
      give_reals(std::sqrt(speed), std::sqrt(duration), Motion::kEvaluations * steps_per_contact);
    };
    if (integrator == 0) measure(SymplecticEuler{});
    if (integrator == 1) measure(VelocityVerlet{});
    if (integrator == 2) measure(ForestRuth{});
  });
}

// ---- Space -------------------------------------------------------------------------------------

/// Forgets all sites in space and builds T for others.
/// @param n  sites, at most 2,000; input: x, y, z, weight of each
LAGRAIN_PAGE int space_build(int n) {
  return done([&] {
    expect_count(n, kMostDiscs, "sites");
    expect_input(4 * static_cast<std::size_t>(n));
    Columns<3> places(3, n);
    Eigen::VectorXd weights(n);
    for (int i = 0; i < n; ++i) {
      const double* site = &input[4 * static_cast<std::size_t>(i)];
      for (int k = 0; k < 4; ++k) {
        expect(std::abs(site[k]) <= kFarthest,
               "site " + in_words(i) + " is further away than a thousand million metres");
      }
      places.col(i) << site[0], site[1], site[2];
      weights[i] = site[3];
    }
    expect(n < 2 || !(places.colwise() - places.col(0)).isZero(0),
           "all " + in_words(n) + " sites lie at one point, where there is nothing to triangulate");
    space.build(places, weights);
  });
}
LAGRAIN_PAGE int space_count() { return space.size(); }
/// Ints: i, j of each edge of T, sorted.
LAGRAIN_PAGE int space_edges() {
  clear_answer();
  give_edges(space.edges());
  return static_cast<int>(ints.size() / 2);
}
/// Ints: four corners of each tetrahedron of T, positive; none if all sites lie in a plane.
LAGRAIN_PAGE int space_tetrahedra() {
  clear_answer();
  space.for_each_tetrahedron([](int a, int b, int c, int d) { give_ints(a, b, c, d); });
  return static_cast<int>(ints.size() / 4);
}
/// Ints: the sites whose cell is empty.
LAGRAIN_PAGE int space_hidden() {
  clear_answer();
  ints.assign(space.hidden().begin(), space.hidden().end());
  return static_cast<int>(ints.size());
}
/// @returns the number of defects that an exact check of T finds
LAGRAIN_PAGE int space_audit() {
  return guarded(-1, [] {
    const auto defects = space.audit();
    if (!defects.empty()) error = defects.front().sentence;
    return static_cast<int>(defects.size());
  });
}
/// Input: x, y, z, w of a, b, c, d. @returns 1 if b - a, c - a, d - a are right-handed, 0 if the
/// four lie in a plane, else -1, exactly; -2: failed
LAGRAIN_PAGE int sign_orientation3() {
  return guarded(-2, [] {
    const auto [a, b, c, d] = sites_in_space<4>();
    return orientation(a, b, c, d);
  });
}
/// Input: x, y, z, w of a, b, c, d, e. @returns 1 if e is in conflict with the tetrahedron a, b, c,
/// d, however that turns, 0 on a tie, else -1, exactly; -2: failed
LAGRAIN_PAGE int sign_power3() {
  return guarded(-2, [] {
    const auto [a, b, c, d, e] = sites_in_space<5>();
    const int turn = orientation(a, b, c, d);
    expect(turn != 0, "the corners of the tetrahedron lie in a plane");
    return turn * power_side(a, b, c, d, e);
  });
}
