#include <lagrain/output.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <system_error>

namespace lagrain {
namespace {

namespace fs = std::filesystem;

constexpr char kAxes[] = "xyz";

/// Rows of comma-separated values.
class Csv {
 public:
  void number(double value) { cell(shortest(value)); }
  void number(std::int64_t value) { cell(std::to_string(value)); }
  void number(int value) { cell(std::to_string(value)); }
  void word(std::string_view text) {
    if (text.find_first_of(",\"\n\r") == std::string_view::npos) {
      cell(text);
      return;
    }
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    cell(quoted + "\"");
  }
  template <int Dim>
  void names(const std::string& stem, const char* unit) {
    for (int d = 0; d < Dim; ++d) word(stem + kAxes[d] + "[" + unit + "]");
  }
  template <class V>
  void vector(const V& v) {
    for (Eigen::Index d = 0; d < v.size(); ++d) number(static_cast<double>(v[d]));
  }
  void end() {
    text_ += '\n';
    first_ = true;
  }
  const std::string& text() const { return text_; }

 private:
  void cell(std::string_view text) {
    if (!first_) text_ += ',';
    first_ = false;
    text_ += text;
  }
  std::string text_;
  bool first_ = true;
};

/// What a frame shows, so that the last good one can be kept.
template <int Dim>
struct Snapshot {
  Columns<Dim> position;
  Columns<Dim> velocity;
  Columns<kSpinDim<Dim>> omega;  ///< no columns where nothing spins
  double time = 0;
  std::int64_t step = 0;

  void take(const Run<Dim>& run) {
    position = run.positions();
    velocity = run.velocities();
    if (run.spins() != nullptr) omega = *run.spins();
    time = run.time();
    step = run.steps();
  }
};

template <int Dim>
std::string frame_text(const Run<Dim>& run, const Columns<Dim>& x, const Columns<Dim>& v,
                       const Columns<kSpinDim<Dim>>* omega) {
  Csv csv;
  csv.word("id[-]");
  csv.names<Dim>("", "m");
  csv.names<Dim>("v", "m/s");
  if (omega != nullptr) {
    if (Dim == 2) {
      csv.word("omega[rad/s]");
    } else {
      csv.names<Dim>("omega_", "rad/s");
    }
  }
  csv.word("radius[m]");
  csv.word("material[-]");
  csv.end();
  for (int i = 0; i < run.count(); ++i) {
    csv.number(i);
    csv.vector(x.col(i));
    csv.vector(v.col(i));
    if (omega != nullptr) csv.vector(omega->col(i));
    csv.number(run.radii()[i]);
    const auto m = static_cast<std::size_t>(run.materials()[static_cast<std::size_t>(i)]);
    csv.word(run.scene().materials[m].name);
    csv.end();
  }
  return csv.text();
}

[[noreturn]] void cannot_write(const fs::path& file, const std::string& reason) {
  throw SceneError(file.string() + ": cannot be written: " + reason);
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "g++ " __VERSION__;
#else
  return "unknown compiler";
#endif
}

std::string numbered(std::int64_t number) {
  std::string digits = std::to_string(number);
  if (digits.size() < 4) digits.insert(0, 4 - digits.size(), '0');
  return digits + ".csv";
}

/// Removes NNNN.csv of an earlier run; whatever else lies there is not ours.
void remove_numbered(const fs::path& folder) {
  std::error_code failure;
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() == ".csv" && stem.size() >= 4 &&
        std::all_of(stem.begin(), stem.end(), [](char c) { return c >= '0' && c <= '9'; })) {
      old.push_back(entry.path());
    }
  }
  for (const fs::path& file : old) fs::remove(file, failure);
}

template <int Dim>
class Recorder {
 public:
  using Clock = std::chrono::steady_clock;

  Recorder(Run<Dim>& run, const RecordOptions& options)
      : run_(run), options_(options), begun_(Clock::now()) {
    const OutputPlan& plan = run.scene().output;
    series_every_ = plan.series_every > 0 ? plan.series_every : run.scene().duration / 1000;
    frames_every_ = plan.frames_every > 0 ? plan.frames_every : run.scene().duration;
    series_every_ = std::max(series_every_, run.time_step());
    frames_every_ = std::max(frames_every_, run.time_step());
    prepare();
    begin_series();
  }

  bool run() {
    note();
    bool stopped = false;
    try {
      while (!run_.finished() && !stopped) {
        if (run_.steps() % kSnapshotEvery == 0) last_.take(run_);
        run_.step(steps_at_once());
        note();
        stopped = options_.stop && options_.stop();
      }
    } catch (const SimulationError& error) {
      // With the last frames comes what the run looked like shortly before.
      write_file(options_.folder / "last.csv",
                 frame_text<Dim>(run_, last_.position, last_.velocity,
                                 run_.spins() != nullptr ? &last_.omega : nullptr));
      finish(std::string("broke off: ") + error.what(), false);
      throw SimulationError(std::string(error.what()) +
                            "; the state at t = " + shortest(last_.time) + " s is kept in " +
                            (options_.folder / "last.csv").string());
    }
    if (run_.steps() != last_frame_) write_frame();
    if (run_.steps() != last_sample_) sample();
    finish(stopped ? "stopped by the user" : "finished", true);
    return !stopped;
  }

 private:
  static constexpr std::int64_t kSnapshotEvery = 64;  // steps

  /// One where all grains lie in the cache, which nothing is gained for. Else as many as pass
  /// without a snapshot, a frame or a sample, and without keeping whoever interrupts waiting.
  std::int64_t steps_at_once() const {
    constexpr int kInCache = 10'000;
    constexpr std::int64_t kGrainSteps = 16'000'000;
    if (run_.count() <= kInCache) return 1;
    const std::int64_t snapshot = (run_.steps() / kSnapshotEvery + 1) * kSnapshotEvery;
    const std::int64_t due = std::min({snapshot, next_frame_, next_sample_, run_.steps_planned()});
    return std::clamp<std::int64_t>(kGrainSteps / run_.count(), 1, due - run_.steps());
  }

  /// The step of the k-th frame or sample. One that would come a step before the end is the last.
  std::int64_t due(std::int64_t k, double every) const {
    const std::int64_t step = std::llround(static_cast<double>(k) * every / run_.time_step());
    return step >= run_.steps_planned() - 1 ? run_.steps_planned() : step;
  }

  void advance(std::int64_t& next, std::int64_t& k, double every) const {
    while (next <= run_.steps() && next < run_.steps_planned()) next = due(++k, every);
  }

  void prepare() {
    const fs::path& folder = options_.folder;
    make_folder(folder);
    make_folder(folder / "frames");
    if (run_.scene().output.contacts) make_folder(folder / "contacts");
    std::error_code ignored;
    remove_numbered(folder / "frames");
    remove_numbered(folder / "contacts");
    for (const char* old : {"last.csv", "series.csv", "frames.csv", "summary.txt"}) {
      fs::remove(folder / old, ignored);
    }
    write_file(folder / "scene.toml", to_toml(run_.scene()));
    frames_.word("frame[-]");
    frames_.word("step[-]");
    frames_.word("time[s]");
    frames_.end();
  }

  void begin_series() {
    for (const char* name :
         {"time[s]", "kinetic[J]", "gravity[J]", "elastic[J]", "wall_work[J]", "dashpot[J]",
          "friction[J]", "residual[J]", "contacts[-]", "wall_contacts[-]", "coordination[-]",
          "mean_overlap[-]", "largest_overlap[-]", "near_pairs[-]", "refreshes[-]"}) {
      series_.word(name);
    }
    for (const Wall<Dim>& wall : run_.walls()) {
      series_.names<Dim>(wall.name + ".f", "N");
      if (wall.moves()) series_.names<Dim>(wall.name + ".", "m");
    }
    series_.end();
  }

  /// After a step: whatever is due.
  void note() {
    if (run_.steps() >= next_sample_) {
      sample();
      advance(next_sample_, samples_due_, series_every_);
    }
    if (run_.steps() >= next_frame_) {
      write_frame();
      advance(next_frame_, frames_due_, frames_every_);
    }
    if (options_.progress) show_progress();
  }

  void sample() {
    const Ledger now = run_.ledger();
    const Ledger& start = run_.start();
    const ContactStatistics s = run_.statistics();
    const double left = residual(now, start);
    for (const double value : {run_.time(), now.kinetic, now.gravity, now.elastic, now.wall_work,
                               now.dashpot, now.friction, left}) {
      series_.number(value);
    }
    series_.number(s.contacts);
    series_.number(s.wall_contacts);
    series_.number(s.coordination);
    series_.number(s.mean_overlap);
    series_.number(s.largest_overlap);
    series_.number(static_cast<std::int64_t>(run_.near_pairs().size()));
    series_.number(run_.refreshes());
    for (const Wall<Dim>& wall : run_.walls()) {
      series_.vector(wall.force);
      if (wall.moves()) series_.vector(wall.point);
    }
    series_.end();

    largest_overlap_ = std::max(largest_overlap_, s.largest_overlap);
    largest_residual_ = std::max(largest_residual_, std::abs(left));
    for (const double energy : {now.kinetic, now.gravity - start.gravity, now.elastic,
                                now.wall_work, now.dashpot, now.friction}) {
      largest_energy_ = std::max(largest_energy_, std::abs(energy));
    }
    last_sample_ = run_.steps();
  }

  void write_frame() {
    const std::string name = numbered(frame_count_);
    write_file(options_.folder / "frames" / name, frame_csv(run_));
    if (run_.scene().output.contacts) {
      write_file(options_.folder / "contacts" / name, contacts_csv(run_));
    }
    frames_.number(frame_count_++);
    frames_.number(run_.steps());
    frames_.number(run_.time());
    frames_.end();
    write_file(options_.folder / "frames.csv", frames_.text());
    write_file(options_.folder / "series.csv", series_.text());
    last_frame_ = run_.steps();
  }

  void finish(const std::string& ending, bool sound) {
    write_file(options_.folder / "series.csv", series_.text());
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
      line("largest sampled overlap", rounded(100 * largest_overlap_) + " % of the smaller radius");
      line("largest residual",
           rounded(largest_residual_) + " J" +
               (largest_energy_ > 0 ? ", " + rounded(100 * largest_residual_ / largest_energy_) +
                                          " % of the largest energy in the ledger"
                                    : std::string()));
    } else {
      line("steps", std::to_string(run_.steps()));
    }
    const double spent = std::chrono::duration<double>(Clock::now() - begun_).count();
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
    const double spent = std::chrono::duration<double>(now - begun_).count();
    p.seconds_left = p.fraction > 0 ? spent / p.fraction * (1 - p.fraction) : 0;
    options_.progress(p);
  }

  Run<Dim>& run_;
  const RecordOptions& options_;
  Clock::time_point begun_;
  Clock::time_point shown_{};
  double series_every_ = 0;  // [s]
  double frames_every_ = 0;  // [s]
  std::int64_t samples_due_ = 0;
  std::int64_t frames_due_ = 0;
  std::int64_t next_sample_ = 0;  // step
  std::int64_t next_frame_ = 0;   // step
  Csv series_;
  Csv frames_;
  std::int64_t frame_count_ = 0;
  std::int64_t last_frame_ = -1;
  std::int64_t last_sample_ = -1;
  Snapshot<Dim> last_;
  double largest_overlap_ = 0;
  double largest_residual_ = 0;
  double largest_energy_ = 0;
};

}  // namespace

const char* version() {
  return LAGRAIN_VERSION;
}

void write_file(const fs::path& file, std::string_view text) {
  const fs::path part = file.string() + ".part";
  errno = 0;
  std::ofstream out(part, std::ios::binary);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  std::error_code failure;
  if (!out) {
    const std::string reason = errno != 0 ? std::strerror(errno) : "unknown error";
    fs::remove(part, failure);
    cannot_write(file, reason);
  }
  fs::rename(part, file, failure);
  if (failure) {
    std::error_code ignored;
    fs::remove(part, ignored);
    cannot_write(file, failure.message());
  }
}

void make_folder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) cannot_write(folder, failure.message());
  if (!fs::is_directory(folder, failure)) cannot_write(folder, "it is no folder");
  const fs::path probe = folder / ".lagrain";
  write_file(probe, "");
  fs::remove(probe, failure);
}

template <int Dim>
std::string frame_csv(const Run<Dim>& run) {
  return frame_text<Dim>(run, run.positions(), run.velocities(), run.spins());
}

template <int Dim>
std::string contacts_csv(const Run<Dim>& run) {
  Csv csv;
  csv.word("i[-]");
  csv.word("j[-]");
  csv.word("overlap[m]");
  csv.names<Dim>("n", "-");
  csv.names<Dim>("f", "N");
  csv.end();
  for (const ContactRecord<Dim>& contact : run.contacts()) {
    csv.number(contact.i);
    if (contact.wall < 0) {
      csv.number(contact.j);
    } else {
      csv.word(run.walls()[static_cast<std::size_t>(contact.wall)].name);
    }
    csv.number(contact.overlap);
    csv.vector(contact.normal);
    csv.vector(contact.force);
    csv.end();
  }
  return csv.text();
}

template <int Dim>
bool record(Run<Dim>& run, const RecordOptions& options) {
  return Recorder<Dim>(run, options).run();
}

template std::string frame_csv<2>(const Run<2>&);
template std::string frame_csv<3>(const Run<3>&);
template std::string contacts_csv<2>(const Run<2>&);
template std::string contacts_csv<3>(const Run<3>&);
template bool record<2>(Run<2>&, const RecordOptions&);
template bool record<3>(Run<3>&, const RecordOptions&);

}  // namespace lagrain
