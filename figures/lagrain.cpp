// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The program `lagrain`: runs scenes, draws figures, reports how fast it is.
///
/// Exit codes: 0 done, 1 the simulation went wrong, 2 the input is wrong, 130 stopped by Ctrl-C.

#include "figure.hpp"
#include "picture_commands.hpp"
#include "report.hpp"
#include "sweep.hpp"
#include "teach.hpp"
#include "terminal.hpp"
#include "watch_page.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/units.hpp>
#include <lagrain/words.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;
using namespace lagrain;

constexpr int kSimulationFailed = 1;
constexpr int kBadInput = 2;
constexpr int kStopped = 130;  // 128 + SIGINT, as shells have it

constexpr const char* kUntil = "--until";
constexpr const char* kCheckpointEvery = "--checkpoint-every";
constexpr const char* kSet = "--set";

volatile std::sig_atomic_t stop_requested = 0;

extern "C" void request_stop(int signal) {
  stop_requested = 1;
  // A second Ctrl-C must work even if a step never ends.
  std::signal(signal, SIG_DFL);
}

bool stopping() { return stop_requested != 0; }

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  char text[32];
  if (whole < 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
  }
  return text;
}

/// Whatever the sentence quotes, the terminal obeys none of it.
int complain(const std::string& sentence, int code) {
  std::cerr << "lagrain: " << readable(sentence) << "\n";
  return code;
}

/// What running and resuming have in common.
struct RecordArguments {
  int threads = 0;
  double checkpoint_every = RecordOptions{}.checkpoint_every;  // [s]
  bool watch = false;
};

/// The time [s] that a flag gives.
/// @throws CLI::ValidationError if it is none
double seconds_of(const std::string& flag, const std::string& text) {
  try {
    const Quantity time = parse_quantity(text);
    if (time.unit == Unit{.second = 1} && time.value >= 0) return time.value;
  } catch (const std::invalid_argument&) {  // said below
  }
  throw CLI::ValidationError(flag,
                             "expected a time such as \"90 s\" or \"2 min\", got \"" + text + "\"");
}

/// Records a run, with progress on a terminal, and says how it ended.
/// @param record_run  record_run(options)
template <int Dim, class Record>
int record_with_progress(const Run<Dim>& run, const fs::path& folder,
                         const RecordArguments& arguments, Record&& record_run) {
  RecordOptions options;
  options.folder = folder;
  options.stop = stopping;
  options.checkpoint_every = arguments.checkpoint_every;
  ProgressLine line;
  std::optional<figures::WatchPage<Dim>> page;
  if (arguments.watch) page.emplace(run, folder);
  if (line.terminal() || page) {
    options.progress = [&](const Progress& p) {
      if (page) page->look(p);
      line.show(fixed(100 * p.fraction, 0) + " %  t = " + rounded(p.time, 4) + " s of " +
                rounded(run.scene().duration, 4) + " s  " + std::to_string(p.contacts) +
                " contacts  " + clock_text(p.seconds_left) + " left");
    };
  }
  bool finished = false;
  try {
    finished = record_run(options);
  } catch (const SimulationError& error) {
    if (page) page->end(std::string("broke off: ") + error.what());
    throw;
  }
  if (page) page->end(finished ? "finished" : "stopped");
  line.clear();
  if (finished) {
    std::cout << "wrote " << folder.string() << "\n";
    return 0;
  }
  std::cerr << "lagrain: stopped at t = " << rounded(run.time(), 4)
            << " s; what was computed is in " << folder.string() << " (to go on: lagrain resume "
            << folder.string() << ")\n";
  return kStopped;
}

struct RunArguments : RecordArguments {
  std::string scene;
  std::string out;
  Settings settings;
  bool explain = false;
};

/// Shows on a terminal how far the placing of grains is, and ends it once the user wants to stop:
/// it throws Interrupted then.
PlacementWatch placement_watch() {
  Pace pace;
  pace.is_due();  // what takes less than a moment needs no words
  return [line = std::make_shared<ProgressLine>(), pace](std::int64_t placed,
                                                         std::int64_t asked) mutable {
    if (stopping()) throw Interrupted();
    if (!line->terminal() || !pace.is_due()) return;
    line->show("placing grains: " + grouped(placed) +
               (asked > placed ? " of " + grouped(asked) : std::string()));
  };
}

template <int Dim>
int run_scene(const RunArguments& arguments) {
  const auto run = make_run(read_scene<Dim>(arguments.scene, arguments.settings), arguments.threads,
                            placement_watch());
  if (arguments.explain) {
    std::cout << explain(*run);
    return 0;
  }
  const fs::path folder = arguments.out.empty()
                              ? fs::path("runs") / fs::path(arguments.scene).stem()
                              : fs::path(arguments.out);
  return record_with_progress(*run, folder, arguments,
                              [&](const RecordOptions& options) { return record(*run, options); });
}

int run_command(const RunArguments& arguments) {
  try {
    return scene_dimension(arguments.scene, arguments.settings) == 2 ? run_scene<2>(arguments)
                                                                     : run_scene<3>(arguments);
  } catch (const Interrupted&) {
    return complain("stopped while grains were placed; nothing was written", kStopped);
  }
}

struct SweepArguments : RecordArguments {
  std::string scene;
  std::string out;
  Settings settings;
  std::vector<std::string> variations;
  int jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::string plot = SweepPlan{}.plot;
};

int sweep_command(const SweepArguments& arguments) {
  SweepPlan plan;
  plan.scene = arguments.scene;
  plan.settings = arguments.settings;
  for (const std::string& text : arguments.variations) {
    plan.variations.push_back(read_variation(text));
  }
  plan.folder = arguments.out.empty()
                    ? fs::path("runs") / (fs::path(arguments.scene).stem().string() + "_sweep")
                    : fs::path(arguments.out);
  plan.jobs = arguments.jobs;
  plan.plot = arguments.plot;
  plan.checkpoint_every = arguments.checkpoint_every;
  ProgressLine line;
  const SweepProgress end = sweep(plan, stopping, [&](const SweepProgress& p) {
    line.show(fixed(100 * p.fraction, 0) + " %  " + std::to_string(p.finished) + " of " +
              std::to_string(p.runs) + " runs are finished" +
              (p.broken > 0 ? ", " + std::to_string(p.broken) + " broke off" : std::string()));
  });
  line.clear();
  const std::string finished =
      std::to_string(end.finished) + " of " + std::to_string(end.runs) + " runs are finished";
  const std::string table = (plan.folder / "results.csv").string();
  if (end.finished + end.broken < end.runs) {
    return complain(
        "stopped; " + finished + ", see " + table + " (to go on: the same command again)",
        kStopped);
  }
  std::cout << "wrote " << table << "\n";
  if (end.broken == 0) return 0;
  return complain(
      finished + ", " + std::to_string(end.broken) + " broke off: " + table + " says why",
      kSimulationFailed);
}

struct ResumeArguments : RecordArguments {
  std::string folder;
  std::optional<double> until;  // [s]
};

template <int Dim>
int resume_scene(const ResumeArguments& arguments, const Checkpoint& checkpoint) {
  const auto run =
      resume_run<Dim>(checkpoint, arguments.until, arguments.threads, placement_watch());
  if (run->finished()) {
    std::cout << arguments.folder << " is at its end, t = " << rounded(run->time(), 4)
              << " s; to go further: --until\n";
    return 0;
  }
  std::cout << "from t = " << rounded(run->time(), 4) << " s\n";
  return record_with_progress(*run, arguments.folder, arguments, [&](const RecordOptions& options) {
    return record_on(*run, checkpoint, options);
  });
}

int resume_command(const ResumeArguments& arguments) {
  const Checkpoint checkpoint = read_checkpoint(arguments.folder);
  if (!checkpoint.trouble.empty()) {
    std::cerr << "lagrain: " << checkpoint.trouble << "; taking " << checkpoint.file.string()
              << " instead\n";
  }
  try {
    return checkpoint_dimension(checkpoint) == 2 ? resume_scene<2>(arguments, checkpoint)
                                                 : resume_scene<3>(arguments, checkpoint);
  } catch (const Interrupted&) {
    return complain("stopped before the first step; " + arguments.folder + " is as it was",
                    kStopped);
  }
}

struct FigureArguments {
  std::vector<int> numbers;
  std::string out = "gallery";
  bool quick = false;
};

/// Progress on a terminal, at most ten times a second.
void show_progress(FigureOptions& options, ProgressLine& line) {
  if (!line.terminal()) return;
  options.progress = [&line, pace = Pace()](double fraction, const std::string& doing) mutable {
    if (!pace.is_due()) return;
    line.show(fixed(100 * fraction, 0) + " %  " + doing);
  };
}

/// Draws figures, and says so line by line.
void draw(const std::vector<int>& numbers, const FigureOptions& options, ProgressLine& line) {
  draw_figures(all_figures(), numbers, options, [&](const std::string& text) {
    line.clear();
    std::cout << text << std::endl;
  });
}

/// What comes with the program: its scenes, its lessons. A program run from where it was built
/// finds those of the sources, an installed one those that were installed with it.
fs::path data_folder(const char* name) {
  if (fs::is_directory(LAGRAIN_DATA)) return fs::path(LAGRAIN_DATA) / name;
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  return program.parent_path() / LAGRAIN_DATA_FROM_PROGRAM / name;
}

FigureOptions options_of(const FigureArguments& arguments) {
  FigureOptions options;
  options.out = arguments.out;
  options.quick = arguments.quick;
  options.stop = stopping;
  options.scenes = data_folder("scenes");
  return options;
}

int figure_command(const FigureArguments& arguments) {
  FigureOptions options = options_of(arguments);
  ProgressLine line;
  show_progress(options, line);
  draw(arguments.numbers, options, line);
  std::cout << "gallery: " << (options.out / "index.html").string() << "\n";
  return 0;
}

int report_command(const FigureArguments& arguments) {
  FigureOptions options = options_of(arguments);
  ProgressLine line;
  show_progress(options, line);
  std::vector<int> numbers;
  for (const Figure& figure : all_figures()) {
    if (figure.page == Page::report) numbers.push_back(figure.number);
  }
  // No number means all figures; without the renderer there are none.
  if (!numbers.empty()) draw(numbers, options, line);
  bench::write_speed_report(options);
  line.clear();
  std::cout << "report: " << (options.out / "report.html").string() << "\n";
  return 0;
}

#ifdef LAGRAIN_WITH_RENDER
int teach_command(const fs::path& out) {
  figures::TeachOptions options;
  options.sources = data_folder("teach");
  options.module =
      fs::exists(LAGRAIN_MODULE) ? fs::path(LAGRAIN_MODULE) : options.sources / "lagrain.js";
  options.out = out;
  const figures::TeachReport report = figures::write_lessons(options);
  std::cout << "wrote " << report.lessons << " lessons: " << (out / "index.html").string() << "\n";
  if (!report.moves) {
    std::cerr << "lagrain: " << options.module.string()
              << " is not there, so pictures stand still; figures/run --teach builds it\n";
  }
  return 0;
}
#endif

void add_checkpoint_option(CLI::App& app, RecordArguments& arguments) {
  app.add_option_function<std::string>(
         kCheckpointEvery,
         [&](const std::string& text) {
           arguments.checkpoint_every = seconds_of(kCheckpointEvery, text);
         },
         "wall-clock time between checkpoints, from which a run can be resumed")
      ->default_str(rounded(arguments.checkpoint_every) + " s");
}

void add_record_options(CLI::App& app, RecordArguments& arguments) {
  app.add_option("--threads", arguments.threads,
                 "at most so many threads share a step (default: all cores from 10,000 grains on)")
      ->check(CLI::Range(1, 1024));
  app.add_flag("--watch", arguments.watch,
               "keep a page watch.html in the folder that shows how far the run is");
  add_checkpoint_option(app, arguments);
}

/// The sentence about the first command or flag that there is not; empty if there are all. CLI11
/// would blame the words behind it.
std::string unknown_word(CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty()) return {};
  CLI::App* command = &app;
  std::size_t first = 0;
  if (!words[0].starts_with('-')) {
    std::vector<std::string> names;
    std::string list;
    for (const CLI::App* known : app.get_subcommands({})) {
      names.push_back(known->get_name());
      list += (list.empty() ? "" : ", ") + names.back();
    }
    if (std::find(names.begin(), names.end(), words[0]) == names.end()) {
      return "unknown command " + shown(words[0]) + suggestion(words[0], names) + "; there are " +
             list;
    }
    command = app.get_subcommand(words[0]);
    first = 1;
  }
  std::vector<std::string> flags;
  for (const CLI::Option* option : command->get_options()) {
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  }
  for (std::size_t k = first; k < words.size() && words[k] != "--"; ++k) {
    if (!words[k].starts_with("--")) continue;
    const std::string flag = words[k].substr(0, words[k].find('='));
    if (std::find(flags.begin(), flags.end(), flag) != flags.end()) continue;
    return "unknown flag " + shortened(flag) + suggestion(flag, flags);
  }
  return {};
}

void add_settings(CLI::App& app, Settings& settings) {
  app.add_option(kSet, settings,
                 "a key of the scene and its value, \"law.friction=0.3\"; again for each")
      ->allow_extra_args(false);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Granular simulation of discs and spheres on dynamic regular triangulations."};
  app.name("lagrain");
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("lagrain ") + version());

  RunArguments run;
  CLI::App* run_app = app.add_subcommand("run", "Run a scene and write a folder");
  run_app->add_option("scene", run.scene, "scene file (TOML)")->required();
  run_app->add_option("--out", run.out, "folder to write (default: runs/NAME of the scene)");
  add_settings(*run_app, run.settings);
  add_record_options(*run_app, run);
  run_app->add_flag("--explain", run.explain, "say what the scene is made of; run nothing");

  ResumeArguments resume;
  CLI::App* resume_app = app.add_subcommand("resume", "Go on with a run from its last checkpoint");
  resume_app->add_option("folder", resume.folder, "folder of the run")->required();
  resume_app->add_option_function<std::string>(
      kUntil, [&](const std::string& text) { resume.until = seconds_of(kUntil, text); },
      "new end, \"2.5 s\" (default: the scene's)");
  add_record_options(*resume_app, resume);

  SweepArguments sweep;
  CLI::App* sweep_app =
      app.add_subcommand("sweep", "Run a scene with several values of its keys, side by side");
  sweep_app->add_option("scene", sweep.scene, "scene file (TOML)")->required();
  sweep_app
      ->add_option("--vary", sweep.variations,
                   "a key and its values, \"law.friction=0.1,0.3\"; again for each")
      ->required()
      ->allow_extra_args(false);
  add_settings(*sweep_app, sweep.settings);
  sweep_app->add_option("--out", sweep.out,
                        "folder to write (default: runs/NAME_sweep of the scene)");
  sweep_app->add_option("--jobs", sweep.jobs, "runs at a time, each with one thread")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  sweep_app->add_option("--plot", sweep.plot, "column of the series that is drawn against time")
      ->capture_default_str();
  add_checkpoint_option(*sweep_app, sweep);

  const figures::PictureCommands pictures(app);

  FigureArguments figure;
  CLI::App* figure_app = app.add_subcommand("figure", "Draw figures and their gallery");
  figure_app->add_option("numbers", figure.numbers, "which figures (default: all)");
  figure_app->add_option("--out", figure.out, "folder to write")->capture_default_str();
  figure_app->add_flag("--quick", figure.quick, "same pictures from smaller scenes");

  FigureArguments report;
  CLI::App* report_app =
      app.add_subcommand("report", "Draw the report's figures, then measure speed beside others");
  report_app->add_option("--out", report.out, "folder to write")->capture_default_str();
  report_app->add_flag("--quick", report.quick, "small scenes and few steps");

#ifdef LAGRAIN_WITH_RENDER
  std::string lessons = "lessons";
  CLI::App* teach_app =
      app.add_subcommand("teach", "Write lessons that run the library in a browser");
  teach_app->add_option("--out", lessons, "folder to write")->capture_default_str();
#endif

  const std::string unknown = unknown_word(app, {argv + 1, argv + argc});
  if (!unknown.empty()) return complain(unknown + " (see lagrain --help)", kBadInput);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {  // --help, --version
    return app.exit(wish);
  } catch (const CLI::ParseError& error) {
    return complain(std::string(error.what()) + " (see lagrain --help)", kBadInput);
  }

  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  try {
    if (report_app->parsed()) return report_command(report);
#ifdef LAGRAIN_WITH_RENDER
    if (teach_app->parsed()) return teach_command(lessons);
#endif
    if (resume_app->parsed()) return resume_command(resume);
    if (sweep_app->parsed()) return sweep_command(sweep);
    if (pictures.parsed()) return pictures.run(stopping);
    return run_app->parsed() ? run_command(run) : figure_command(figure);
  } catch (const SceneError& error) {
    return complain(error.what(), kBadInput);
  } catch (const Interrupted&) {
    if (pictures.parsed()) return complain("stopped; the film is not finished", kStopped);
    return report_app->parsed()
               ? complain("stopped; what was measured is in " + report.out, kStopped)
               : complain("stopped; what was drawn is in " + figure.out, kStopped);
  } catch (const SimulationError& error) {
    return complain(error.what(), kSimulationFailed);
  } catch (const std::exception& error) {
    return complain(std::string("internal error: ") + error.what(), kSimulationFailed);
  }
}
