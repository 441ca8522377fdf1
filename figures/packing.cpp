// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing.hpp"

#include "together.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/laguerre3.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/style.hpp>
#include <lagrain/triangulation3.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

namespace lagrain::figures {

namespace {

constexpr double kSampleEvery = 0.002;  // [s]

double solid_volume(const Eigen::VectorXd& radius) {
  return 4.0 / 3 * std::numbers::pi * radius.array().cube().sum();
}

/// The inside of a box of half-spaces, each of which bounds it on one side.
Eigen::AlignedBox3d inside_of(const std::vector<Wall<3>>& walls) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Eigen::AlignedBox3d box(Vec<3>::Constant(-kFar), Vec<3>::Constant(kFar));
  for (const Wall<3>& wall : walls) {
    const Vec<3>& normal = std::get<HalfSpace<3>>(wall.shape).normal;
    for (int axis = 0; axis < 3; ++axis) {
      if (normal[axis] > 0.5) box.min()[axis] = std::max(box.min()[axis], wall.point[axis]);
      if (normal[axis] < -0.5) box.max()[axis] = std::min(box.max()[axis], wall.point[axis]);
    }
  }
  return box;
}

class Runner {
 public:
  Runner(const PackingJob& job, const Watch& watch) : job_(job), watch_(watch) {}

  Packing run() {
    const auto start = std::chrono::steady_clock::now();
    const std::unique_ptr<Run<3>> run = make_run(job_.scene, 1);  // the jobs share the cores
    Packing packing;
    packing.name = job_.name;
    packing.at_first = inside_of(run->walls());
    const double solid = solid_volume(run->radii());
    double next = 0;
    while (!run->finished()) {
      if (!watch_(run->time() / job_.scene.duration)) return packing;
      run->step();
      if (run->time() < next && !run->finished()) continue;
      next += kSampleEvery;
      packing.time.push_back(run->time());
      packing.density.push_back(solid / inside_of(run->walls()).volume());
      packing.largest_overlap =
          std::max(packing.largest_overlap, run->statistics().largest_overlap);
    }
    packing.position = run->positions();
    packing.radius = run->radii();
    packing.box = inside_of(run->walls());
    std::tie(packing.bulk, packing.bulk_count) =
        bulk_density(packing.position, packing.radius, packing.box);
    packing.statistics = run->statistics();
    packing.audited = run->audit().contacts();
    packing.missed = run->audit().missed();
    packing.steps = run->steps();
    if (const TriangulationCost* cost = run->neighbourhood().cost()) packing.cost = *cost;
    packing.edges_per_site = static_cast<double>(run->neighbourhood().edges()) / run->count();
    packing.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    packing.neighbourhood_share = run->neighbourhood_seconds() / packing.seconds;
    const Ledger ledger = run->ledger();
    packing.residual_share = run->energy_residual() / (ledger.dashpot + ledger.friction);
    return packing;
  }

 private:
  const PackingJob& job_;
  const Watch& watch_;
};

/// About how long a scene takes: the contact time, and with it the step, goes with the radius.
double work_of(const Scene<3>& scene) {
  double grains = 0, smallest = std::numeric_limits<double>::infinity();
  for (const Fill<3>& fill : scene.fills) {
    grains += *fill.count;
    smallest = std::min(smallest, std::get<double>(fill.radius));
  }
  return grains * scene.duration / smallest;
}

/// One row per sample.
std::string density_csv(const std::vector<Packing>& packings) {
  Csv csv("packing,time[s],density[-]");
  for (const Packing& p : packings) {
    for (std::size_t k = 0; k < p.time.size(); ++k) csv.row(p.name, p.time[k], p.density[k]);
  }
  return csv.text();
}

}  // namespace

Scene<3> packing_scene(const FigureOptions& options, const std::string& file) {
  Scene<3> scene = read_scene<3>(options.scenes / file);
  if (!options.quick) return scene;
  for (Fill<3>& fill : scene.fills) {
    fill.count = *fill.count / 8;
    fill.radius = 2 * std::get<double>(fill.radius);
  }
  scene.law.stiffness *= 2.0 / 8;  // proportional to the radius, and softer: half the steps
  scene.audit = false;  // against all pairs at every step, it would cost more than the run
  return scene;
}

Scene<3> shaken(Scene<3> scene, double seconds) {
  const double stop = kShakeStart + std::round(seconds * kShakeFrequency) / kShakeFrequency;
  for (Wall<3>& wall : scene.walls) {
    if (wall.moves()) continue;
    wall.motion =
        Shake<3>{Vec<3>(kShakeAmplitude, 0, kShakeAmplitude), kShakeFrequency, kShakeStart, stop};
  }
  scene.duration = stop + kRest;
  return scene;
}

Scene<3> with_friction(Scene<3> scene, double friction) {
  scene.law.friction = friction;
  if (friction == 0) scene.friction = FrictionModel::none;
  return scene;
}

std::vector<Packing> run_packings(const std::vector<PackingJob>& jobs, const FigureOptions& options,
                                  const std::filesystem::path& csv) {
  static std::map<std::string, Packing> kept;  // by the scene that was run
  std::vector<std::string> keys;
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    const std::string key = to_toml(jobs[k].scene);
    if (!kept.contains(key) && std::find(keys.begin(), keys.end(), key) == keys.end()) {
      open.push_back(k);
    }
    keys.push_back(key);
  }
  // The longest first, so that all cores come to an end together.
  std::stable_sort(open.begin(), open.end(), [&](std::size_t a, std::size_t b) {
    return work_of(jobs[a].scene) > work_of(jobs[b].scene);
  });

  std::vector<Packing> results(jobs.size());
  const auto run_job = [&](std::size_t k, const Watch& watch) {
    results[open[k]] = Runner(jobs[open[k]], watch).run();
  };
  try {
    do_together(open.size(), run_job, options, "packings");
  } catch (...) {
    write_file(csv, density_csv(results));
    throw;
  }
  for (const std::size_t k : open) kept[keys[k]] = results[k];
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    results[k] = kept.at(keys[k]);
    results[k].name = jobs[k].name;
  }
  write_file(csv, density_csv(results));
  return results;
}

std::pair<double, int> bulk_density(const Columns<3>& position, const Eigen::VectorXd& radius,
                                    const Eigen::AlignedBox3d& box) {
  Triangulation<3> triangulation;
  triangulation.build(position, radius.array().square().matrix());
  const double margin = 3 * radius.maxCoeff();
  double solid = 0, cells = 0;
  int count = 0;
  for (int i = 0; i < triangulation.size(); ++i) {
    const Vec<3> x = position.col(i);
    if (((x - box.min()).array() < margin).any() || ((box.max() - x).array() < margin).any()) {
      continue;
    }
    solid += 4.0 / 3 * std::numbers::pi * std::pow(radius[i], 3);
    cells += polyhedron_volume(laguerre_cell(triangulation, i, box));
    ++count;
  }
  return {solid / cells, count};
}

std::string packing_csv(const Packing& packing) {
  Csv csv("x[m],y[m],z[m],radius[m]");
  for (Eigen::Index i = 0; i < packing.position.cols(); ++i) {
    csv.vector(packing.position.col(i));
    csv.number(packing.radius[i]);
    csv.end();
  }
  return csv.text();
}

Series density_series(const Packing& packing, int index, double from) {
  Series series = series_style(index);
  series.name = packing.name;
  for (std::size_t k = 0; k < packing.time.size(); ++k) {
    if (packing.time[k] < from) continue;
    series.x.push_back(packing.time[k]);
    series.y.push_back(packing.density[k]);
  }
  return series;
}

void add_packing(DisplayList& list, const Vec<2>& low, double width, const Packing& packing,
                 ColourBy by, bool quick, const std::string& text) {
  Scene3 scene;
  const Box3 whole{packing.at_first.min(), packing.at_first.max()};
  const double smallest = packing.radius.minCoeff();
  for (Eigen::Index i = 0; i < packing.radius.size(); ++i) {
    const Vec<3> x = packing.position.col(i);
    const Colour tint = by == ColourBy::height
                            ? colour(ColourMap::viridis, (x.z() - whole.low.z()) / whole.size().z())
                        : packing.radius[i] > 1.01 * smallest
                            ? mix(category(0), style::kPaper, 0.2)
                            : mix(category(1), style::kPaper, 0.2);
    scene.balls.push_back({x, packing.radius[i], tint});
  }
  add_edges(scene, whole);
  const Vec<3> a = whole.low;
  const Vec<3> b{whole.high.x(), whole.high.y(), packing.box.max().z()};
  if (b.z() < whole.high.z()) {
    const std::array<Vec<3>, 4> piston{Vec<3>(a.x(), a.y(), b.z()), Vec<3>(b.x(), a.y(), b.z()),
                                       Vec<3>(b.x(), b.y(), b.z()), Vec<3>(a.x(), b.y(), b.z())};
    scene.panes.push_back({piston});
    for (std::size_t k = 0; k < 4; ++k) {
      scene.lines.push_back({piston[k], piston[(k + 1) % 4], {style::kWall, style::kMedium}});
    }
  }
  scene.floor = Floor{whole.low.z()};
  scene.camera = camera_framing(whole, {0.5, 0.8, -0.4}, {0, 0, 1}, 1, 0.4);
  scene.subframes = quick ? kPreviewSubframes : kPrintSubframes;
  list.add(paint_scene3(scene, Box{low, low + Vec<2>(width, width)}));
  list.add(Label{.text = text,
                 .at = {low[0] + width / 2, low[1] - 2},
                 .size = style::kText,
                 .across = Across::centre,
                 .along = Along::top});
}

std::string digits(double density) { return rounded(density, 3); }

std::string difference_text(double density, double paper) {
  const std::string difference = rounded(density - paper, 2);
  return density < paper ? difference : "+" + difference;
}

std::string quick_text(bool quick) {
  return quick ? " (quick: an eighth as many, twice as large)" : "";
}

void add_title(DisplayList& list, const Vec<2>& at, const std::string& text) {
  list.add(Label{.text = text, .at = at, .size = style::kTitle, .along = Along::top});
}

std::string bulk_text(const Packing& packing) {
  if (packing.bulk_count == 0) return "no cell away from the walls";
  return digits(packing.bulk) + " in the " + std::to_string(packing.bulk_count) +
         " cells away from the walls";
}

std::vector<Fact> packing_facts(const std::vector<Packing>& packings) {
  std::int64_t audited = 0, missed = 0, steps = 0, grain_steps = 0;
  double seconds = 0, overlap = 0, share = 0, residual = 0;
  TriangulationCost cost;
  for (const Packing& p : packings) {
    audited += p.audited;
    missed += p.missed;
    steps += p.steps;
    grain_steps += p.steps * p.radius.size();
    seconds += p.seconds;
    share += p.neighbourhood_share * p.seconds;
    overlap = std::max(overlap, p.largest_overlap);
    residual = std::max(residual, std::abs(p.residual_share));
    cost.ladder += p.cost.ladder;
    cost.updates += p.cost.updates;
    cost.moved += p.cost.moved;
    cost.searched += p.cost.searched;
    cost.leaps += p.cost.leaps;
    cost.walks += p.cost.walks;
  }
  return {{"runs", std::to_string(packings.size()) + ", " + std::to_string(steps) + " steps"},
          {"time", rounded(seconds) + " s of one core, " +
                       rounded(1e9 * seconds / static_cast<double>(grain_steps)) +
                       " ns per grain and step, audit included; " +
                       rounded(100 * share / seconds, 2) + " % of it for the neighbourhood"},
          {"contacts audited, missed", audited > 0
                                           ? std::to_string(audited) + ", " + std::to_string(missed)
                                           : "none audited (quick)"},
          {"largest overlap at any sample", rounded(100 * overlap, 2) + " % of the smaller radius"},
          {"largest energy residual", rounded(100 * residual, 2) + " % of what was dissipated"},
          {"triangulation updates", std::to_string(cost.updates) + ", " +
                                        std::to_string(cost.moved) + " grains moved, " +
                                        std::to_string(cost.ladder.flips) + " flips"},
          {"leaps", std::to_string(cost.leaps) + " builds with wide skins, left by " +
                        std::to_string(cost.walks) + " grains"},
          {"repairs", std::to_string(cost.ladder.extracted) + " grains taken out, " +
                          std::to_string(cost.ladder.unstuck) + " cavities filled anew, " +
                          std::to_string(cost.ladder.rebuilds) + " rebuilds, " +
                          std::to_string(cost.searched) + " range searches"}};
}

}  // namespace lagrain::figures
