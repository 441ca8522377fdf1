// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 18 (report): hard cases, and what happens to them.
//
// One row of the table per case, with the number that decides it; panels for those where a number
// is not enough. The cases are functions of hard_cases.hpp, and tests assert on the same ones.

#include "diagrams.hpp"
#include "hard_cases.hpp"
#include "measure.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/run.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::figures {

namespace {

using namespace hard_cases;

/// Lengths of the cases that have one.
struct Lengths {
  std::int64_t tower_steps, pile_steps, gas_grain_steps, scales_steps;
  int tower_height, shots;
  std::vector<double> distances;
};

Lengths lengths(bool quick) {
  if (quick) return {30000, 30000, 200000, 3000, 30, 16, {1, 1e6}};
  return {800000, 150000, 10000000, 30000, 100, 64, {1, 1e2, 1e4, 1e6, 1e8}};
}

/// An error message, quoted, without the remedy or the condition that follows it.
std::string quoted(const std::string& message) {
  return "\"" + message.substr(0, std::min(message.find(';'), message.find(" (expected"))) + "\"";
}

/// A theory's curve: a line without markers.
Series theory(int index, const std::string& name, double from, double to,
              const std::function<double(double)>& f, bool log) {
  constexpr int kPoints = 100;
  Series line = series_style(index);
  line.name = name;
  line.width = 0.6;
  line.dashes = {3, 2};
  for (int k = 0; k <= kPoints; ++k) {
    const double t = static_cast<double>(k) / kPoints;
    const double x = log ? from * std::pow(to / from, t) : from + t * (to - from);
    line.x.push_back(x);
    line.y.push_back(f(x));
  }
  return line;
}

/// The diagrams, in their order.
enum Letter : std::size_t { kTowers, kPile, kGas, kFast, kStep, kFar };

/// The page as it grows.
class HardCases {
 public:
  explicit HardCases(const FigureOptions& options)
      : options_(options), lengths_(lengths(options.quick)) {
    table_.head = {"case", "what could go wrong", "what happened", "number"};
  }

  FigureResult draw() {
    using Part = void (HardCases::*)();
    const std::vector<std::pair<std::string, Part>> parts{
        {"crystals", &HardCases::crystals},
        {"towers", &HardCases::towers},
        {"a heavy grain on light ones", &HardCases::heavy},
        {"a giant and dust", &HardCases::dust},
        {"a wedge", &HardCases::wedge},
        {"rows", &HardCases::rows},
        {"one place", &HardCases::one_place},
        {"far from the origin", &HardCases::far},
        {"nine decades of radii", &HardCases::scales},
        {"fast grains", &HardCases::fast},
        {"large steps", &HardCases::steps},
        {"piles", &HardCases::piles},
        {"an elastic gas", &HardCases::gas},
        {"numbers that are none", &HardCases::not_numbers},
        {"walls", &HardCases::walls},
        {"a shrinking box", &HardCases::shrinking}};
    for (std::size_t k = 0; k < parts.size(); ++k) {
      options_.progress(static_cast<double>(k) / static_cast<double>(parts.size()), parts[k].first);
      check_stop_();
      (this->*parts[k].second)();
    }
    for (const Letter letter : {kGas, kStep, kFar}) {
      leave_room_for_legend(diagrams_[letter].plot);
    }
    draw_diagrams(diagrams_, 2, 170, options_, "fig18", result_);
    write_table();
    result_.facts = {{"contacts looked for a second time", std::to_string(all_.audited)},
                     {"of these missed", std::to_string(all_.missed)},
                     {"grains lost", std::to_string(all_.lost)}};
    result_.tables = {table_};
    result_.caption =
        "Hard cases. (a) Towers of discs put down without overlap come to rest as the slowest mode "
        "of each decays in theory (dashed). (b) A pile on a rough floor: with elastic friction it "
        "freezes, its discs too slow for a step to change the last bit of a place (dashed); with "
        "viscous friction it creeps. (c) Energy of an elastic gas, and one standard deviation of "
        "the random walk that independent errors of its collisions make (dashed). (d) A disc shot "
        "at a pinned one, against its way in a step: it bounces while its overlap keeps to the "
        "limit, beyond it the run stops: for a deep overlap, or because the disc passed between "
        "two steps (dashed: the share for whom no step ends in a deep overlap before). (e) Elastic "
        "collisions by Hertz's law against the time step; beyond 1 the run was deceived about the "
        "speed of impact. (f) A crystal at rest against the same far from the origin. What to take "
        "from it: elastic friction for what must stand; contacts so stiff that no grain goes "
        "further than some hundredths of its radius in a step (the run stops otherwise); half of "
        "the safe step for an error of " +
        percent(half_step_error_) +
        " in a collision's energy; and an origin within a million radii, where overlaps are right "
        "to " +
        rounded(million_error_, 1) + " of a radius.";
    return std::move(result_);
  }

 private:
  void row(const std::string& name, const std::string& danger, const std::string& happened,
           const std::string& number) {
    table_.rows.push_back({name, danger, happened, number});
  }

  /// What a run says of itself.
  std::string story(const Outcome& o) {
    all_.audited += o.audited;
    all_.missed += o.missed;
    all_.lost += o.lost;
    if (!o.stopped.empty()) return "stops: " + quoted(o.stopped);
    return "runs; " + std::to_string(o.missed) + " of " + std::to_string(o.audited) +
           " contacts missed, " + std::to_string(o.lost) + " grains lost";
  }

  void save(const std::string& name, const Csv& csv) {
    write_file(options_.out / (name + ".csv"), csv.text());
    result_.downloads.push_back(name + ".csv");
  }

  void write_table() {
    Csv csv("case,danger,happened,number");
    const auto plain = [](std::string text) {  // a cell is quoted already
      std::erase(text, '"');
      return text;
    };
    for (const auto& r : table_.rows) csv.row(plain(r[0]), plain(r[1]), plain(r[2]), plain(r[3]));
    save("fig18_cases", csv);
  }

  // ---- At rest ---------------------------------------------------------------------------------

  void crystals() {
    const std::vector<std::pair<std::string, Crystal>> crystals{
        {"square lattice of discs at rest", Crystal::square},
        {"hexagonal lattice of discs", Crystal::hexagonal},
        {"face-centred cubic lattice of spheres", Crystal::face_centred}};
    for (const auto& [name, crystal] : crystals) {
      const CrystalAtRest r = crystal_at_rest(crystal, check_stop_);
      row(name, "every tie that a triangulation has; a lattice that buckles or chatters",
          story(r) + "; " + std::to_string(r.contacts) + " contacts at the end, " +
              std::to_string(r.brute_force) + " by brute force, " + std::to_string(r.strangers) +
              " of them new neighbours",
          "grains moved by at most " + rounded(r.move, 2) +
              " r, in the mean as the springs explain to " +
              rounded(std::abs(r.sink / r.explained - 1), 2));
    }
  }

  void towers() {
    Csv csv("height[-],step[-],largest_force_error[-],theory[-],last_bit[-]");
    Plot plot{.x = {.label = "steps", .log = true},
              .y = {.label = "largest error of a contact force", .log = true, .low = 1e-16},
              .series = {},
              .legend = Corner::bottom_left};
    const auto add = [&](int height, std::int64_t steps, int index) {
      Tower r = tower(height, steps, check_stop_);
      Series measured = series_style(index);
      measured.name = std::to_string(height) + " discs";
      const auto mode = [&](double step) {
        return 4 / std::numbers::pi * std::exp(-r.decay * step);
      };
      for (const TowerSample& s : r.samples) {
        measured.x.push_back(s.steps);
        measured.y.push_back(s.error);
        csv.row(height, s.steps, s.error, mode(s.steps), r.last_bit);
      }
      plot.series.push_back(
          theory(index, "", r.samples.front().steps, r.samples.back().steps, mode, true));
      plot.series.push_back(std::move(measured));
      return r;
    };
    add(lengths_.tower_height / 5, lengths_.tower_steps / 8, 1);
    const Tower r = add(lengths_.tower_height, lengths_.tower_steps, 0);
    row("tower of " + std::to_string(lengths_.tower_height) + " discs",
        "an ill-conditioned chain; weights do not add up", story(r),
        "contact forces to " + rounded(r.samples.back().error, 2) + " after " +
            std::to_string(lengths_.tower_steps) +
            " steps (theory: the slowest mode has decayed to " +
            rounded(4 / std::numbers::pi * std::exp(-r.decay * r.samples.back().steps), 2) + ")");
    diagrams_[kTowers] = {"(a) towers come to rest", std::move(plot)};
    save("fig18_tower", csv);
  }

  void heavy() {
    const auto add = [&](const std::string& name, const HeavyOnLight& r) {
      row(name, "stiff and slow at once; the light ones are crushed", story(r),
          "floor carries the weight to " + rounded(r.floor_error, 2) +
              " (theory: swing decayed to " +
              rounded(std::exp(-r.decay * static_cast<double>(r.steps)), 2) +
              "), walls the thrust to " + rounded(r.wall_error, 2) + " (overlap " +
              rounded(r.overlap, 2) + " r)");
    };
    add("heavy disc on light ones, density 1000 : 1", heavy_on_light<2>(check_stop_));
    add("heavy sphere on light ones, density 1000 : 1", heavy_on_light<3>(check_stop_));
  }

  void dust() {
    const GiantAndDust r = giant_and_dust(check_stop_);
    row("giant and 300 grains of dust, radii 1000 : 1",
        "tiny cells against a huge one; dust lost in the cleft",
        story(r) + "; " + std::to_string(r.rebuilds) + " rebuilds of the triangulation",
        std::to_string(r.giant_contacts) + " grains touch the giant; ledger closes to " +
            percent(std::abs(r.residual)) + " of what was dissipated");
  }

  void wedge() {
    const Wedge r = tiny_disc_between_giants(check_stop_);
    row("tiny disc wedged between two giants, 1 : 1000",
        "a contact force eleven times the weight, at a flat angle", story(r),
        "flanks bear " + rounded(r.force, 4) + " weights, closed form to " +
            rounded(std::abs(r.force / r.closed_form - 1), 2));
  }

  // ---- Degenerate places -----------------------------------------------------------------------

  void rows() {
    const auto add = [&](const std::string& name, const Row& r) {
      row(name, "a triangulation without area or volume", story(r),
          "speed handed on 19 times to " + rounded(std::abs(r.speed - 1), 2) + " (bound " +
              rounded(r.bound, 2) + "); at most " + rounded(r.sideways, 2) + " r off the row");
    };
    add("20 discs in a row", row_of_grains<2>(false, check_stop_));
    add("20 discs in a slanted row", row_of_grains<2>(true, check_stop_));
    add("20 spheres in a row", row_of_grains<3>(false, check_stop_));
    add("20 spheres in a slanted row", row_of_grains<3>(true, check_stop_));
  }

  void one_place() {
    const auto add = [&](const std::string& name, const OnePlace& r) {
      row(name, "division by a distance of 0; all sites but one hidden",
          "refused: " + quoted(r.refused) + ". If allowed, stops: " + quoted(r.stopped) +
              ". Without any limit, " + story(r.free),
          std::to_string(r.pairs) + " of " + std::to_string(r.grains * (r.grains - 1) / 2) +
              " pairs listed; they fly " + rounded(r.separation, 2) +
              " diameters apart, momentum kept to " + rounded(r.momentum, 2));
    };
    add("10 discs at the same point", all_in_one_place<2>(check_stop_));
    add("10 spheres at the same point", all_in_one_place<3>(check_stop_));
  }

  void far() {
    Csv csv("distance[r],overlap_error[r],bound[r],last_bit[r],force_error[weight]");
    Series error = curve(0, "difference of overlaps"), bound = series_style(1),
           bit = series_style(2);
    bound.name = "its bound";
    bit.name = "last bit of a place";
    FarAway million;
    for (const double distance : lengths_.distances) {
      const FarAway r = far_from_origin(distance, check_stop_);
      if (distance == 1e6) million = r;
      csv.row(distance, r.overlap_error, r.bound, r.last_bit, r.force_error);
      for (Series* s : {&error, &bound, &bit}) s->x.push_back(distance);
      error.y.push_back(r.overlap_error);
      bound.y.push_back(r.bound);
      bit.y.push_back(r.last_bit);
    }
    million_error_ = million.overlap_error;
    row("crystal a million radii from the origin", "places keep ten digits instead of sixteen",
        story(million),
        "overlaps as at the origin to " + rounded(million.overlap_error, 2) + " r (" +
            rounded(million.overlap_error / million.last_bit, 2) + " last bits), forces to " +
            rounded(million.force_error, 2) + " weights");
    diagrams_[kFar] = {"(f) far from the origin",
                       {.x = {.label = "distance from the origin [radii]", .log = true},
                        .y = {.label = "overlap at rest [radii]", .log = true},
                        .series = {error, bound, bit},
                        .legend = Corner::top_left}};
    save("fig18_far", csv);
  }

  void scales() {
    const Scales r = nine_decades_of_radii(lengths_.scales_steps, check_stop_);
    std::string number;
    for (const Bounce& b : r.bounces) {
      number += (number.empty() ? "speed of " : "; of ") + rounded(b.radius, 2) + " m to " +
                rounded(b.speed_error, 2) + " (bound " + rounded(b.bound, 2) + ")";
    }
    row("discs of 1 um, 1 mm and 1 m hit one of 1 km", "eighteen decades of masses and weights",
        story(r), number);
  }

  // ---- Speed and step --------------------------------------------------------------------------

  void fast() {
    Csv csv(
        "way_per_step[r],bounced[-],refused[-],crossed[-],unseen[-],crossed_by_theory[-],shots[-]");
    Series bounced = curve(0, "bounced"), refused = curve(1, "stopped: deep overlap"),
           crossed = curve(2, "stopped: passed through");
    FastGrain all;  // of all shots
    const std::vector<double> ways{0.01, 0.02, 0.03, 0.06, 0.1, 0.3, 1,  2,
                                   3,    4,    6,    10,   20,  50,  100};
    for (const double way : ways) {
      const FastGrain r = fast_grain(way, lengths_.shots, check_stop_);
      for (Series* s : {&bounced, &refused, &crossed}) s->x.push_back(way);
      bounced.y.push_back(static_cast<double>(r.bounced) / r.shots);
      refused.y.push_back(static_cast<double>(r.refused) / r.shots);
      crossed.y.push_back(static_cast<double>(r.crossed) / r.shots);
      csv.row(way, r.bounced, r.refused, r.crossed, r.unseen, r.expected, r.shots);
      all.audited += r.audited;
      all.missed += r.missed;
      all.unseen += r.unseen;
      if (way == 10) all.expected = r.expected, all.crossed = r.crossed, all.shots = r.shots;
      all.bounce_up_to = r.bounce_up_to;
    }
    row("disc faster than its radius per step",
        "it outruns the near list, or passes through others between two steps",
        "bounces up to " + rounded(all.bounce_up_to, 2) +
            " r per step; a faster one stops the run, for a deep overlap or for its passage. " +
            story(all),
        "at 10 r per step " + std::to_string(all.crossed) + " of " + std::to_string(all.shots) +
            " pass through and stop the run (theory " + rounded(all.expected * all.shots, 3) +
            "); " + std::to_string(all.unseen) + " unseen");
    diagrams_[kFast] = {
        "(d) a disc shot at a pinned one",
        {.x = {.label = "way of the disc in a step [radii]", .log = true},
         .y = {.label = "share of the shots", .low = -0.05, .high = 1.45},
         .series = {theory(
                        2, "", 1.7, 100, [](double w) { return 1 - 1.7 / w; }, true),
                    bounced, refused, crossed},
         .legend = Corner::top_left}};
    save("fig18_fast", csv);
  }

  void steps() {
    Csv csv("step[safe_steps],energy_error[-],overlap_error[-]");
    Series energy = curve(0, "energy"), overlap = curve(1, "deepest overlap");
    std::string number;
    for (const double x : {0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0}) {
      const StepSize r = collisions_at_step(x, check_stop_);
      energy.x.push_back(x);
      energy.y.push_back(r.energy_error);
      overlap.x.push_back(x);
      overlap.y.push_back(r.overlap_error);
      csv.row(x, r.energy_error, r.overlap_error);
      if (x == 0.5) half_step_error_ = r.energy_error;
      if (x >= 1 && x <= 4) {
        number += (number.empty() ? "energy of a collision to " : ", ") + percent(r.energy_error) +
                  " at " + rounded(x, 2);
      }
    }
    row("time step at the safe one, and beyond", "wrong collisions, then an explosion",
        "accepted at 1 safe step" + std::string(refusal_of_step(1).empty() ? "" : " (no)") +
            "; at 1.001: \"" + refusal_of_step(1.001) + "\"",
        number + " safe steps (beyond 1 the scene named too low a speed of impact)");
    diagrams_[kStep] = {"(e) collisions against the time step",
                        {.x = {.label = "time step [safe steps]", .log = true},
                         .y = {.label = "worst relative error", .log = true},
                         .series = {energy, overlap},
                         .legend = Corner::top_left}};
    save("fig18_step", csv);
  }

  // ---- Long runs -------------------------------------------------------------------------------

  void piles() {
    Csv csv("friction,time[s],kinetic[J],top[m],rounding_floor[J]");
    Plot plot{.x = {.label = "time [s]"},
              .y = {.label = "kinetic energy [J]", .log = true, .low = 1e-25, .high = 1e9},
              .series = {},
              .legend = Corner::top_right};
    const auto add = [&](FrictionModel model, int index) {
      const Pile r = pile(model, lengths_.pile_steps, check_stop_);
      Series line = series_style(index);
      line.name = std::string(name_of(model)) + " friction";
      for (const PileSample& s : r.samples) {
        line.x.push_back(s.time);
        line.y.push_back(s.kinetic);
        csv.row(std::string(name_of(model)), s.time, s.kinetic, s.top, r.rounding_floor);
      }
      if (index == 0) {
        plot.series.push_back(theory(
            2, "too slow to move", 0, r.samples.back().time,
            [&](double) { return r.rounding_floor; }, false));
      }
      plot.series.push_back(std::move(line));
      row("pile of " + std::to_string(r.grains) + " discs, " + std::string(name_of(model)) +
              " friction",
          model == FrictionModel::elastic ? "it creeps, or trembles for ever"
                                          : "it creeps: this model has no memory to hold it",
          story(r),
          "drift in the last " + rounded(r.drift_seconds, 2) + " s: " + rounded(r.drift, 2) +
              " r; kinetic energy " + rounded(r.samples.back().kinetic, 2) + " J");
    };
    add(FrictionModel::elastic, 0);
    add(FrictionModel::viscous, 1);
    diagrams_[kPile] = {"(b) a pile that must not creep", std::move(plot)};
    save("fig18_pile", csv);
  }

  void gas() {
    const Gas r = elastic_gas(lengths_.gas_grain_steps, check_stop_);
    Csv csv("grain_steps[-],energy_drift[-],random_walk[-]");
    Series drift = series_style(0);
    drift.name = "energy";
    const double end = r.samples.back().grain_steps;
    const auto walk = [&](double x) { return r.random_walk * std::sqrt(x / end); };
    for (const GasSample& s : r.samples) {
      drift.x.push_back(s.grain_steps / 1e6);
      drift.y.push_back(100 * s.drift);
      csv.row(s.grain_steps, s.drift, walk(s.grain_steps));
    }
    const auto branch = [&](double sign) {
      return theory(
          1, sign > 0 ? "random walk" : "", 0, end / 1e6,
          [&, sign](double x) { return 100 * sign * walk(1e6 * x); }, false);
    };
    row("elastic gas of " + std::to_string(r.grains) + " discs, " + rounded(end, 2) +
            " grain-steps",
        "energy that grows or leaks; grains that escape",
        story(r) + "; about " + rounded(r.collisions, 3) + " collisions",
        "energy at the end off by " + rounded(r.samples.back().drift, 2) +
            " (random walk of the collisions' errors: " + rounded(r.random_walk, 2) + ")");
    diagrams_[kGas] = {"(c) energy of an elastic gas",
                       {.x = {.label = "grain-steps [millions]"},
                        .y = {.label = "change of energy [%]"},
                        .series = {branch(1), branch(-1), drift},
                        .legend = Corner::top_left}};
    save("fig18_gas", csv);
  }

  // ---- What must stop --------------------------------------------------------------------------

  void not_numbers() {
    const std::filesystem::path folder = options_.out / "fig18_overflow";
    const NotANumber r = not_a_number(folder, check_stop_);
    const std::string danger = "it spreads silently";
    row("NaN in a scene file", danger, "refused: " + quoted(r.in_file), "0 steps");
    row("NaN from a program", danger, "refused: " + quoted(r.in_program), "0 steps");
    row("a place that overflows in the run", danger + ", and spoils the last state",
        story(r.overflow),
        r.last_is_sound ? "last.csv holds all grains, and numbers alone" : "last.csv is not sound");
    row("a grain at 1e150 m/s", "its square overflows; predicates see no numbers", story(r.huge),
        std::to_string(r.huge.steps) + " steps");
    result_.downloads.push_back("fig18_overflow/last.csv");
  }

  void walls() {
    const PushedThrough r = pushed_through_walls(check_stop_);
    row("a lid that comes down too fast", "grains appear on its far side", story(r.lid),
        std::to_string(r.lid.steps) + " steps");
    row("a floor of mud", "grains sink through", story(r.soft_floor),
        std::to_string(r.soft_floor.steps) + " steps");
  }

  void shrinking() {
    const std::filesystem::path folder = options_.out / "fig18_shrinking";
    const Shrinking r = shrinking_box(folder, check_stop_);
    row("a box that shrinks until nothing fits", "an explosion, or a hang", story(r),
        "jammed at a solid fraction of " + rounded(r.jammed, 3) + "; " +
            (r.last_is_sound ? "last.csv holds all " + std::to_string(r.grains) + " grains"
                             : "last.csv is not sound"));
    result_.downloads.push_back("fig18_shrinking/last.csv");
  }

  const FigureOptions& options_;
  Lengths lengths_;
  StopCheck check_stop_ = [this] { options_.check_stop(); };
  FigureResult result_;
  Table table_;
  std::vector<Diagram> diagrams_{kFar + 1};
  Outcome all_;  // of the cases so far
  double half_step_error_ = 0, million_error_ = 0;
};

}  // namespace

FigureResult draw_figure18(const FigureOptions& options) { return HardCases(options).draw(); }

}  // namespace lagrain::figures
