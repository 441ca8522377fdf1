// SPDX-License-Identifier: GPL-3.0-or-later
#include "start.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <system_error>
#include <vector>

namespace lagrain {
namespace {

namespace fs = std::filesystem;

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "g++ " __VERSION__;
#else
  return "unknown compiler";
#endif
}

/// The steps at which something is due that repeats every so many seconds.
template <int Dim>
class Schedule {
 public:
  Schedule(const Run<Dim>& run, double every)
      : run_(run), every_(std::max(every, run.time_step())) {}

  bool is_due() const { return run_.steps() >= next_; }
  std::int64_t next() const { return next_; }
  void advance() {
    while (next_ <= run_.steps() && next_ < run_.steps_planned()) next_ = step_of(++count_);
  }
  /// Keeps or restores it, at a step at which nothing is due any more.
  void persist(StateVisitor visit, const std::string& name) {
    visit(name, count_);
    if (!visit.restores()) return;
    next_ = step_of(count_);
    advance();
  }

 private:
  /// One that would come a step before the end is the last.
  std::int64_t step_of(std::int64_t k) const {
    const std::int64_t step = std::llround(static_cast<double>(k) * every_ / run_.time_step());
    return step >= run_.steps_planned() - 1 ? run_.steps_planned() : step;
  }

  const Run<Dim>& run_;
  double every_;  // [s]
  std::int64_t count_ = 0;
  std::int64_t next_ = 0;
};

/// The largest of what the samples of a run showed.
struct Largest {
  double overlap = 0;   // of the smaller radius [-]
  double residual = 0;  // [J]
  double energy = 0;    // in the ledger [J]

  void persist(StateVisitor visit) {
    visit("overlap", overlap);
    visit("residual", residual);
    visit("energy", energy);
  }

  void look_at(const Ledger& now, const Ledger& start, const ContactStatistics& statistics) {
    overlap = std::max(overlap, statistics.largest_overlap);
    residual = std::max(residual, std::abs(lagrain::residual(now, start)));
    for (const double e :
         {now.kinetic, now.gravity - start.gravity, now.elastic, now.wall_work, now.dashpot,
          now.friction, now.carried, now.gravity_work, now.driven_work, now.force_work}) {
      energy = std::max(energy, std::abs(e));
    }
  }
};

/// Steps a run to its end and hands frames and samples to the formats when they are due.
template <int Dim>
class Recorder {
 public:
  Recorder(Run<Dim>& run, const RecordOptions& options)
      : run_(run),
        options_(options),
        samples_(run, or_else(run.scene().output.series_every, run.scene().duration / 1000)),
        frames_(run, or_else(run.scene().output.frames_every, run.scene().duration)),
        formats_(make_formats<Dim>(run.scene().output, options.folder)),
        tables_(options.folder) {}

  /// Begins an empty folder.
  void begin() {
    make_folder(options_.folder);
    write_scene();
    std::error_code ignored;
    fs::remove(options_.folder / "summary.txt", ignored);
    remove_checkpoints(options_.folder);
    remove_last();
    tables_.begin(run_);
    for (auto& format : formats_) format->begin(run_);
  }

  /// Keeps where the run and its folder are; or goes on with the folder, where the run is already.
  void persist(const StateVisitor& visit) {
    if (!visit.restores()) {
      run_.persist(visit.in("run"));
      scene_text_ = to_toml(scene_with_copies());
    }
    StateVisitor here = visit.in("record");
    std::int64_t dimension = Dim;
    here("dimension", dimension);
    here("scene", scene_text_);
    samples_.persist(here, "samples");
    frames_.persist(here, "frames");
    here("frame_count", frame_count_);
    here("last_frame", last_frame_);
    here("last_sample", last_sample_);
    largest_.persist(here.in("largest"));
    double spent = seconds_spent();
    here("seconds", spent);
    spent_before_ = visit.restores() ? spent : spent_before_;
    if (visit.restores()) remove_last();
    tables_.persist(here.in("csv"));
    for (auto& format : formats_) format->persist(run_, here.in("formats"), frame_count_);
  }

  bool run() {
    if (last_sample_ < 0) write_what_is_due();
    write_checkpoint();
    bool stopped = false;
    try {
      while (!run_.finished() && !stopped) {
        if (run_.steps() % kStepsBetweenCopies == 0) last_good_ = Frame<Dim>::of(run_);
        run_.step(steps_at_once());
        write_what_is_due();
        stopped = options_.stop && options_.stop();
        if (checkpoint_is_due()) write_checkpoint();
      }
    } catch (const SimulationError& error) {
      const fs::path kept = options_.folder / kLastGood;
      write_file(kept, frame_csv(run_, last_good_));
      write_summary(std::string("broke off: ") + error.what(), false);
      std::string where = kept.string();
      if (go_back()) where += ", and whole in " + checkpoint_file(options_.folder).string();
      throw SimulationError(std::string(error.what()) + "; the state at t = " +
                            rounded(last_good_.time, 6) + " s is kept in " + where);
    }
    // A run that is resumed later shall not see the frame that ends this one.
    if (stopped) write_checkpoint();
    if (run_.steps() != last_frame_) write_frame();
    if (run_.steps() != last_sample_) write_sample();
    if (!stopped) write_checkpoint();
    write_summary(stopped ? "stopped by the user" : "finished", true);
    return !stopped;
  }

  /// Writes the scene, with copies of the files that it reads: it stays what was run, whatever
  /// becomes of them. All are read first, because a copy may take the place of one.
  void write_scene() const {
    const Scene<Dim> scene = scene_with_copies();
    std::vector<std::string> texts;
    for (const auto& grains : run_.scene().grain_files) texts.push_back(read_file(grains.file));
    if (scene.start) {
      write_file(options_.folder / scene.start->run, detail::start_bytes(*run_.scene().start));
    }
    for (std::size_t k = 0; k < texts.size(); ++k) {
      write_file(options_.folder / scene.grain_files[k].file, texts[k]);
    }
    write_file(options_.folder / "scene.toml", to_toml(scene));
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::int64_t kStepsBetweenCopies = 64;  // of the state, in case all goes wrong
  static constexpr const char* kLastGood = "last.csv";

  void remove_last() const {
    std::error_code ignored;
    fs::remove(options_.folder / kLastGood, ignored);
  }

  /// The scene that reads these copies.
  Scene<Dim> scene_with_copies() const {
    Scene<Dim> scene = run_.scene();
    for (std::size_t k = 0; k < scene.grain_files.size(); ++k) {
      scene.grain_files[k].file = "grains_" + std::to_string(k + 1) + ".csv";
    }
    if (scene.start) scene.start->run = "start.h5";
    return scene;
  }

  static double or_else(double value, double otherwise) { return value > 0 ? value : otherwise; }

  /// Where all grains lie in the cache, steps taken together gain nothing: one. Else as many as
  /// pass without a copy, a frame or a sample, and without keeping whoever interrupts waiting.
  std::int64_t steps_at_once() const {
    constexpr int kInCache = 10'000;
    constexpr std::int64_t kGrainSteps = 16'000'000;  // about a second
    if (run_.count() <= kInCache) return 1;
    const std::int64_t copy = (run_.steps() / kStepsBetweenCopies + 1) * kStepsBetweenCopies;
    const std::int64_t due =
        std::min({copy, frames_.next(), samples_.next(), run_.steps_planned()});
    return std::clamp<std::int64_t>(kGrainSteps / run_.count(), 1, due - run_.steps());
  }

  void write_what_is_due() {
    if (samples_.is_due()) {
      write_sample();
      samples_.advance();
    }
    if (frames_.is_due()) {
      write_frame();
      frames_.advance();
    }
    if (options_.progress) show_progress();
  }

  void write_sample() {
    const Ledger now = run_.ledger();
    const ContactStatistics statistics = run_.statistics();
    const Sample sample = sample_of(run_, now, statistics);
    tables_.add_sample(sample);
    largest_.look_at(now, run_.start(), statistics);
    last_sample_ = run_.steps();
  }

  void write_frame() {
    const Frame<Dim> frame = Frame<Dim>::of(run_);
    for (auto& format : formats_) format->add_frame(run_, frame, frame_count_);
    tables_.add_frame(frame, frame_count_);
    ++frame_count_;
    last_frame_ = run_.steps();
  }

  /// @param sound  whether the state can be trusted
  void write_summary(const std::string& ending, bool sound) const {
    std::string text = run_.scene().title + "\n\n";
    const auto line = [&](std::string name, const std::string& value) {
      name.resize(std::max<std::size_t>(name.size() + 1, 26), ' ');
      text += name + value + "\n";
    };
    line("ending", ending);
    line("law", std::string(name_of(run_.scene().normal)) + ", friction " +
                    std::string(name_of(run_.scene().friction)) + ", " +
                    std::string(name_of(run_.scene().integrator)));
    if (sound) {
      for (const auto& [name, value] : facts(run_)) line(name, value);
      line("largest sampled overlap", rounded(100 * largest_.overlap) + " % of the smaller radius");
      std::string share;
      if (largest_.energy > 0) {
        share = ", " + rounded(100 * largest_.residual / largest_.energy) +
                " % of the largest energy in the ledger";
      }
      line("largest residual", rounded(largest_.residual) + " J" + share);
    } else {
      line("steps", std::to_string(run_.steps()));
      line("last good state",
           std::string(kLastGood) + ", at " + rounded(last_good_.time, 6) + " s");
    }
    const double spent = seconds_spent();
    line("wall-clock time", rounded(spent) + " s, " +
                                rounded(100 * run_.neighbourhood_seconds() / spent) +
                                " % of it for the neighbourhood");
    line("lagrain", std::string(version()) + ", " + compiler());
    write_file(options_.folder / "summary.txt", text);
  }

  void show_progress() {
    const auto now = Clock::now();
    if (now - shown_ < std::chrono::milliseconds(200) && !run_.finished()) return;
    shown_ = now;
    Progress p;
    p.fraction = fraction();
    p.time = run_.time();
    const ContactStatistics s = run_.statistics();
    p.contacts = s.contacts + s.wall_contacts;
    const double done = p.fraction - begun_at_;
    p.seconds_left = done > 0 ? seconds_since(begun_) / done * (1 - p.fraction) : 0;
    options_.progress(p);
  }

  // ---- Checkpoints ------------------------------------------------------------------------------

  bool checkpoint_is_due() const {
    constexpr double kShare = 50;  // of the time, at most the inverse goes into checkpoints
    return seconds_since(checkpoint_at_) >
           std::max(options_.checkpoint_every, kShare * checkpoint_took_);
  }
  void write_checkpoint() {
    const auto begin = Clock::now();
    State state;
    persist(StateVisitor::keeping(state));
    tables_.sync_to_disk();
    lagrain::write_checkpoint(options_.folder, state);
    checkpoint_at_ = Clock::now();
    checkpoint_took_ = seconds_since(begin);
  }

  /// Takes the run back to the last good state, and writes a checkpoint there: from the last
  /// checkpoint the same steps lead to the same state, and cost nothing while all goes well.
  /// @return whether it has got there; the user may stop it
  bool go_back() {
    try {
      const Checkpoint last = read_checkpoint(options_.folder);
      run_.persist(StateVisitor::restoring(last.state).in("run"));
      while (run_.steps() < last_good_.step) {
        if (options_.stop && options_.stop()) return false;
        run_.step(std::min(kStepsBetweenCopies, last_good_.step - run_.steps()));
      }
      write_checkpoint();
    } catch (const SceneError&) {
      return false;  // the folder is gone, or full
    }
    return true;
  }

  /// Of the steps that are made [-].
  double fraction() const {
    return static_cast<double>(run_.steps()) / static_cast<double>(run_.steps_planned());
  }
  double seconds_spent() const { return spent_before_ + seconds_since(begun_); }
  static double seconds_since(Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  }

  Run<Dim>& run_;
  const RecordOptions& options_;
  Schedule<Dim> samples_, frames_;
  std::vector<std::unique_ptr<FrameFormat<Dim>>> formats_;
  RunTables<Dim> tables_;
  std::int64_t frame_count_ = 0;
  std::int64_t last_frame_ = -1;   // step
  std::int64_t last_sample_ = -1;  // step
  Frame<Dim> last_good_;
  Largest largest_;
  std::string scene_text_;        // in the folder
  double begun_at_ = fraction();  // [-]
  double spent_before_ = 0;       // by those that it goes on for [s]
  double checkpoint_took_ = 0;    // the last one [s]
  Clock::time_point begun_ = Clock::now();
  Clock::time_point shown_{};
  Clock::time_point checkpoint_at_ = Clock::now();
};

}  // namespace

const char* version() { return LAGRAIN_VERSION; }

template <int Dim>
OutputEstimate estimate_output(const Run<Dim>& run) {
  const OutputPlan& plan = run.scene().output;
  const auto times = [&](double every, double otherwise) {
    return std::floor(run.scene().duration / (every > 0 ? every : otherwise)) + 1;
  };
  const ContactStatistics now = run.statistics();
  const double contacts =
      std::max(static_cast<double>(now.contacts + now.wall_contacts), 1.0 * Dim * run.count());
  OutputEstimate estimate;
  estimate.frames = times(plan.frames_every, run.scene().duration);
  for (const auto& format : make_formats<Dim>(plan, {})) {
    estimate.bytes_per_frame += format->bytes_per_frame(run, contacts);
  }
  constexpr double kBytesPerNumber = 12;  // of the series, where many are short
  const double row = kBytesPerNumber * static_cast<double>(series_columns(run).size());
  const ModelSize size = run.size();
  const double checkpoint = run.count() * static_cast<double>(size.per_grain) +
                            contacts * static_cast<double>(size.memory_per_pair);
  estimate.bytes = estimate.frames * estimate.bytes_per_frame +
                   times(plan.series_every, run.scene().duration / 1000) * row + 2 * checkpoint;
  return estimate;
}

template <int Dim>
bool record(Run<Dim>& run, const RecordOptions& options) {
  Recorder<Dim> recorder(run, options);
  recorder.begin();
  return recorder.run();
}

int checkpoint_dimension(const Checkpoint& checkpoint) {
  int dimension = 0;
  try {
    StateVisitor::restoring(checkpoint.state).in("record")("dimension", dimension);
  } catch (const SceneError& error) {
    throw SceneError(checkpoint.file.string() + ": " + error.what());
  }
  return dimension;
}

template <int Dim>
std::unique_ptr<Run<Dim>> resume_run(const Checkpoint& checkpoint, std::optional<double> until,
                                     int threads, const PlacementWatch& watch) {
  const std::string name = checkpoint.file.string();
  Scene<Dim> scene = parse_scene<Dim>(checkpoint.state.get<std::string>("record/scene"), name);
  for (GrainFile<Dim>& grains : scene.grain_files) {
    grains.file = checkpoint.file.parent_path() / grains.file;
  }
  if (scene.start) scene.start->run = checkpoint.file.parent_path() / scene.start->run;
  if (until) {
    // Rows of the series stay as close to each other as they were.
    OutputPlan& output = scene.output;
    if (!(output.series_every > 0)) output.series_every = scene.duration / 1000;
    scene.duration = *until;
  }
  auto run = make_run(scene, threads, watch);
  try {
    run->persist(StateVisitor::restoring(checkpoint.state).in("run"));
  } catch (const SceneError& error) {
    throw SceneError(name + ": " + error.what());
  }
  if (until && run->time() > *until) {
    throw SceneError(name + ": the run has gone on to " + rounded(run->time(), 6) +
                     " s, further than the " + rounded(*until, 6) + " s that were asked for");
  }
  return run;
}

template <int Dim>
bool record_on(Run<Dim>& run, const Checkpoint& checkpoint, RecordOptions options) {
  options.folder = checkpoint.file.parent_path();
  Recorder<Dim> recorder(run, options);
  try {
    recorder.persist(StateVisitor::restoring(checkpoint.state));
  } catch (const SceneError& error) {
    throw SceneError(checkpoint.file.string() + ": " + error.what());
  }
  recorder.write_scene();
  return recorder.run();
}

template OutputEstimate estimate_output<2>(const Run<2>&);
template OutputEstimate estimate_output<3>(const Run<3>&);
template bool record<2>(Run<2>&, const RecordOptions&);
template bool record<3>(Run<3>&, const RecordOptions&);
template std::unique_ptr<Run<2>> resume_run<2>(const Checkpoint&, std::optional<double>, int,
                                               const PlacementWatch&);
template std::unique_ptr<Run<3>> resume_run<3>(const Checkpoint&, std::optional<double>, int,
                                               const PlacementWatch&);
template bool record_on<2>(Run<2>&, const Checkpoint&, RecordOptions);
template bool record_on<3>(Run<3>&, const Checkpoint&, RecordOptions);

}  // namespace lagrain
