// SPDX-License-Identifier: GPL-3.0-or-later
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

  void look_at(const Ledger& now, const Ledger& start, const ContactStatistics& statistics) {
    overlap = std::max(overlap, statistics.largest_overlap);
    residual = std::max(residual, std::abs(lagrain::residual(now, start)));
    for (const double e : {now.kinetic, now.gravity - start.gravity, now.elastic, now.wall_work,
                           now.dashpot, now.friction, now.carried}) {
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
        frames_(run, or_else(run.scene().output.frames_every, run.scene().duration)) {
    formats_.push_back(std::make_unique<CsvFormat<Dim>>(options.folder));
    make_folder(options.folder);
    std::error_code ignored;
    fs::remove(options.folder / "summary.txt", ignored);
    write_scene();
    for (auto& format : formats_) format->begin(run);
  }

  bool run() {
    write_what_is_due();
    bool stopped = false;
    try {
      while (!run_.finished() && !stopped) {
        if (run_.steps() % kStepsBetweenCopies == 0) last_good_ = Frame<Dim>::of(run_);
        run_.step(steps_at_once());
        write_what_is_due();
        stopped = options_.stop && options_.stop();
      }
    } catch (const SimulationError& error) {
      fs::path kept;
      for (auto& format : formats_) kept = format->write_last(run_, last_good_);
      write_summary(std::string("broke off: ") + error.what(), false);
      throw SimulationError(std::string(error.what()) + "; the state at t = " +
                            shortest(last_good_.time) + " s is kept in " + kept.string());
    }
    if (run_.steps() != last_frame_) write_frame();
    if (run_.steps() != last_sample_) write_sample();
    write_summary(stopped ? "stopped by the user" : "finished", true);
    return !stopped;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::int64_t kStepsBetweenCopies = 64;  // of the state, in case all goes wrong

  /// Writes the scene, with copies of the files that it reads: it stays what was run, whatever
  /// becomes of them. All are read first, because a copy may take the place of one.
  void write_scene() const {
    Scene<Dim> scene = run_.scene();
    std::vector<std::string> texts;
    for (const GrainFile<Dim>& grains : scene.grain_files) texts.push_back(read_file(grains.file));
    for (std::size_t k = 0; k < texts.size(); ++k) {
      scene.grain_files[k].file = "grains_" + std::to_string(k + 1) + ".csv";
      write_file(options_.folder / scene.grain_files[k].file, texts[k]);
    }
    write_file(options_.folder / "scene.toml", to_toml(scene));
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
    for (auto& format : formats_) format->add_sample(sample);
    largest_.look_at(now, run_.start(), statistics);
    last_sample_ = run_.steps();
  }

  void write_frame() {
    const Frame<Dim> frame = Frame<Dim>::of(run_);
    for (auto& format : formats_) format->add_frame(run_, frame, frame_count_);
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
    }
    const double spent = seconds_since(begun_);
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
    p.fraction = static_cast<double>(run_.steps()) / static_cast<double>(run_.steps_planned());
    p.time = run_.time();
    const ContactStatistics s = run_.statistics();
    p.contacts = s.contacts + s.wall_contacts;
    p.seconds_left = p.fraction > 0 ? seconds_since(begun_) / p.fraction * (1 - p.fraction) : 0;
    options_.progress(p);
  }

  static double seconds_since(Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  }

  Run<Dim>& run_;
  const RecordOptions& options_;
  std::vector<std::unique_ptr<RunFormat<Dim>>> formats_;
  Schedule<Dim> samples_, frames_;
  std::int64_t frame_count_ = 0;
  std::int64_t last_frame_ = -1;   // step
  std::int64_t last_sample_ = -1;  // step
  Frame<Dim> last_good_;
  Largest largest_;
  Clock::time_point begun_ = Clock::now();
  Clock::time_point shown_{};
};

}  // namespace

const char* version() { return LAGRAIN_VERSION; }

template <int Dim>
bool record(Run<Dim>& run, const RecordOptions& options) {
  return Recorder<Dim>(run, options).run();
}

template bool record<2>(Run<2>&, const RecordOptions&);
template bool record<3>(Run<3>&, const RecordOptions&);

}  // namespace lagrain
