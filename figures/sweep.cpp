// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep.hpp"

#include "figure.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/csv_rows.hpp>
#include <lagrain/output.hpp>
#include <lagrain/units.hpp>
#include <lagrain/words.hpp>

#ifdef LAGRAIN_WITH_RENDER
#include <lagrain/paint.hpp>
#include <lagrain/plot.hpp>
#endif

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace lagrain {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostRuns = 10'000;
constexpr const char* kFinished = "finished";
/// The scene of a run as it was given, with its settings: what tells whether a folder is of it.
constexpr const char* kGiven = "sweep.toml";

/// One run of a sweep.
struct Member {
  std::vector<std::string> values;  // of the variations
  std::string name;                 // of its folder
  Settings settings;
  int dimension = 2;
  std::string given;   // its scene as text
  std::string ending;  // empty: not begun
  double fraction = 0;
  pid_t process = -1;
  int pipe = -1;
  std::string heard;  // from its process: shares of its steps, line by line, then the ending
};

/// A value without the quotes that make it text.
std::string unquoted(const std::string& value) {
  const bool quoted = value.size() >= 2 && value.front() == '"' && value.back() == '"';
  return quoted ? value.substr(1, value.size() - 2) : value;
}

/// A part of the name of a folder.
std::string in_file_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    if (std::string_view(" \"'[]{}").find(c) != std::string_view::npos) continue;
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("._+-=,").find(c) != std::string_view::npos;
    name += plain ? c : '-';
  }
  return name;
}

std::vector<Member> members_of(const SweepPlan& plan) {
  std::size_t count = 1;
  for (const Variation& variation : plan.variations) count *= variation.values.size();
  if (count > kMostRuns) {
    throw SceneError("--vary: " + std::to_string(count) + " runs; expected at most " +
                     std::to_string(kMostRuns));
  }
  std::vector<Member> members(count);
  std::set<std::string> names;
  for (std::size_t k = 0; k < count; ++k) {
    Member& member = members[k];
    member.settings = plan.settings;
    std::size_t block = count;
    for (const Variation& variation : plan.variations) {
      block /= variation.values.size();
      const std::string& value = variation.values[k / block % variation.values.size()];
      member.values.push_back(unquoted(value));
      member.settings.push_back(variation.key + "=" + value);
      member.name += (member.name.empty() ? "" : "_") + in_file_name(variation.key + "=" + value);
    }
    constexpr std::size_t kLongest = 120;  // letters, of the 255 that a file system allows
    if (member.name.size() > kLongest) member.name.resize(kLongest);
    if (!names.insert(member.name).second) {
      member.name += "_" + std::to_string(k + 1);
      names.insert(member.name);
    }
    member.dimension = scene_dimension(plan.scene, member.settings);
    member.given = member.dimension == 2 ? to_toml(read_scene<2>(plan.scene, member.settings))
                                         : to_toml(read_scene<3>(plan.scene, member.settings));
  }
  return members;
}

std::string text_of(const fs::path& file) {
  return why_unreadable(file).empty() ? read_file(file) : std::string();
}

/// What the summary of a run says of its end; empty if there is none.
std::string ending_in(const fs::path& folder) {
  const std::string text = text_of(folder / "summary.txt");
  constexpr std::string_view kKey = "\nending ";
  const auto at = text.find(kKey);
  if (at == std::string::npos) return {};
  const auto begin = text.find_first_not_of(' ', at + kKey.size());
  return begin == std::string::npos ? "" : text.substr(begin, text.find('\n', begin) - begin);
}

// ---- In the process of a run ----------------------------------------------------------------

void say(int pipe, const std::string& line) {
  const std::string text = line + "\n";
  // Whoever listened may be gone, and then it does not matter.
  [[maybe_unused]] const auto written = ::write(pipe, text.data(), text.size());
}

template <int Dim>
bool record_member(const SweepPlan& plan, const Member& member, const RecordOptions& options) {
  if (text_of(options.folder / kGiven) == member.given) {
    std::optional<Checkpoint> checkpoint;
    try {
      checkpoint = read_checkpoint(options.folder);
    } catch (const SceneError&) {  // then it begins anew
    }
    if (checkpoint) {
      const auto run = resume_run<Dim>(*checkpoint, {}, 1);
      return record_on(*run, *checkpoint, options);
    }
  }
  const auto run =
      make_run(read_scene<Dim>(plan.scene, member.settings), 1, [&](std::int64_t, std::int64_t) {
        if (options.stop()) throw Interrupted();
      });
  make_folder(options.folder);
  remove_checkpoints(options.folder);  // of another scene
  write_file(options.folder / kGiven, member.given);
  return record(*run, options);
}

/// @return how the run ended, in one line
std::string run_member(const SweepPlan& plan, const Member& member,
                       const std::function<bool()>& stop, int pipe) {
  RecordOptions options;
  options.folder = plan.folder / member.name;
  options.stop = stop;
  options.checkpoint_every = plan.checkpoint_every;
  options.progress = [&](const Progress& p) { say(pipe, shortest(p.fraction)); };
  try {
    const bool finished = member.dimension == 2 ? record_member<2>(plan, member, options)
                                                : record_member<3>(plan, member, options);
    return finished ? kFinished : "stopped";
  } catch (const Interrupted&) {
    return "stopped";
  } catch (const std::exception& error) {
    return std::string("broke off: ") + error.what();
  }
}

// ---- In the program itself ------------------------------------------------------------------

/// Begins a run in a process of its own: it shares nothing, and takes nobody along if it crashes.
void begin(Member& member, const SweepPlan& plan, const std::function<bool()>& stop) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe for another run");
  member.process = ::fork();
  if (member.process < 0) throw std::runtime_error("no process for another run");
  if (member.process == 0) {
    ::close(ends[0]);
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // a sweep that is killed leaves no run behind
    std::signal(SIGPIPE, SIG_IGN);
    say(ends[1], "= " + readable(run_member(plan, member, stop, ends[1])));
    ::_exit(0);
  }
  ::close(ends[1]);
  member.pipe = ends[0];
  member.ending = "killed";  // unless it says otherwise
}

/// Reads what a run has to say.
/// @return whether it is still there
bool listen(Member& member) {
  char buffer[4096];
  const auto length = ::read(member.pipe, buffer, sizeof buffer);
  if (length <= 0) {
    ::close(member.pipe);
    member.pipe = -1;
    int status = 0;
    ::waitpid(member.process, &status, 0);
    if (WIFSIGNALED(status)) {
      member.ending = "broke off: ended by signal " + std::to_string(WTERMSIG(status));
    }
    return false;
  }
  member.heard.append(buffer, static_cast<std::size_t>(length));
  for (std::size_t end; (end = member.heard.find('\n')) != std::string::npos;) {
    const std::string line = member.heard.substr(0, end);
    member.heard.erase(0, end + 1);
    if (line.starts_with("= ")) {
      member.ending = line.substr(2);
    } else {
      member.fraction = std::strtod(line.c_str(), nullptr);
    }
  }
  return true;
}

SweepProgress progress_of(const std::vector<Member>& members) {
  SweepProgress progress;
  progress.runs = static_cast<int>(members.size());
  for (const Member& member : members) {
    const bool running = member.pipe >= 0;
    const bool finished = !running && member.ending == kFinished;
    const bool broken = !running && !finished && member.ending.starts_with("broke off");
    progress.finished += finished ? 1 : 0;
    progress.broken += broken ? 1 : 0;
    progress.fraction += (finished || broken ? 1 : member.fraction) / progress.runs;
  }
  return progress;
}

void run_all(std::vector<Member>& members, const SweepPlan& plan, const std::function<bool()>& stop,
             const std::function<void(const SweepProgress&)>& progress) {
  std::size_t next = 0;
  bool told = false;
  for (;;) {
    std::vector<pollfd> waiting;
    std::vector<Member*> running;
    for (Member& member : members) {
      if (member.pipe < 0) continue;
      waiting.push_back({member.pipe, POLLIN, 0});
      running.push_back(&member);
    }
    if (stop() && !told) {
      for (const Member* member : running) ::kill(member->process, SIGTERM);
      told = true;
    }
    while (!told && next < members.size() && running.size() < static_cast<std::size_t>(plan.jobs)) {
      Member& member = members[next++];
      const fs::path folder = plan.folder / member.name;
      if (text_of(folder / kGiven) == member.given && ending_in(folder) == kFinished) {
        member.ending = kFinished;
        continue;
      }
      begin(member, plan, stop);
      waiting.push_back({member.pipe, POLLIN, 0});
      running.push_back(&member);
    }
    progress(progress_of(members));
    if (running.empty()) return;
    constexpr int kPatience = 200;  // until somebody may want to stop [ms]
    ::poll(waiting.data(), waiting.size(), kPatience);
    for (std::size_t k = 0; k < waiting.size(); ++k) {
      if (waiting[k].revents != 0) listen(*running[k]);
    }
  }
}

// ---- Results --------------------------------------------------------------------------------

/// The series of a run: names of the columns, and whole rows.
struct SeriesTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

SeriesTable series_in(const fs::path& folder) {
  SeriesTable table;
  const std::string text = text_of(folder / "series.csv");
  const std::size_t whole = text.rfind('\n') + 1;  // a row may not be written to its end yet
  for (CsvRows rows(std::string_view(text).substr(0, whole)); rows.next();) {
    std::vector<std::string> cells(rows.cells().begin(), rows.cells().end());
    if (table.head.empty()) {
      table.head = std::move(cells);
    } else if (cells.size() == table.head.size()) {
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

std::optional<Quantity> quantity_in(const std::string& text) {
  try {
    return parse_quantity(text);
  } catch (const std::invalid_argument&) {
    return {};
  }
}

/// Each run's series is read twice rather than all of them kept.
void write_results(const SweepPlan& plan, const std::vector<Member>& members) {
  std::vector<std::string> columns;  // of all series
  std::vector<std::string> names{"run[-]"};
  for (std::size_t v = 0; v < plan.variations.size(); ++v) {
    // Without a unit it is the scene's, in SI.
    std::string unit;
    for (const Member& member : members) {
      const auto quantity = quantity_in(member.values[v]);
      if (quantity && unit.empty()) unit = to_string(quantity->unit);
    }
    names.push_back(plan.variations[v].key + (unit.empty() ? "" : "[" + unit + "]"));
  }
  names.emplace_back("ending[-]");
  for (const Member& member : members) {
    if (member.ending.empty()) continue;
    for (const std::string& name : series_in(plan.folder / member.name).head) {
      if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
    }
  }
  Csv csv;
  for (const std::string& name : names) csv.word(name);
  for (const std::string& name : columns) csv.word(name);
  csv.end();
  for (const Member& member : members) {
    csv.word(member.name);
    for (const std::string& value : member.values) {
      if (const auto quantity = quantity_in(value)) {
        csv.number(quantity->value);
      } else {
        csv.word(value);
      }
    }
    csv.word(member.ending.empty() ? "not begun" : member.ending);
    const SeriesTable series =
        member.ending.empty() ? SeriesTable{} : series_in(plan.folder / member.name);
    for (const std::string& name : columns) {
      const auto at = std::find(series.head.begin(), series.head.end(), name);
      const bool known = at != series.head.end() && !series.rows.empty();
      csv.word(known ? series.rows.back()[static_cast<std::size_t>(at - series.head.begin())] : "");
    }
    csv.end();
  }
  write_file(plan.folder / "results.csv", csv.text());
}

#ifdef LAGRAIN_WITH_RENDER
/// Text as a label shows it, where dollars and backslashes are markup.
std::string literal(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '$' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

void draw(const SweepPlan& plan, const std::vector<Member>& members) {
  constexpr std::size_t kMostNamed = 12;  // a longer legend would hide the curves
  Plot plot;
  plot.x.label = "time [s]";
  plot.legend = members.size() <= kMostNamed ? Corner::top_right : Corner::none;
  std::set<std::string> known;
  for (const Member& member : members) {
    if (member.ending.empty()) continue;
    const SeriesTable table = series_in(plan.folder / member.name);
    for (std::size_t k = 0; k < table.head.size(); ++k) {
      const std::string& title = table.head[k];
      const std::string name = title.substr(0, title.rfind('['));
      known.insert(name);
      if (name != plan.plot && title != plan.plot) continue;
      plot.y.label = literal(name + " " + title.substr(name.size()));
      Series series = series_style(static_cast<int>(&member - members.data()));
      for (std::size_t v = 0; v < member.values.size(); ++v) {
        series.name += (v > 0 ? ", " : "") +
                       literal(shortened(plan.variations[v].key + " = " + member.values[v], 40));
      }
      for (const auto& row : table.rows) {
        series.x.push_back(std::strtod(row.front().c_str(), nullptr));
        series.y.push_back(row[k].empty() ? std::numeric_limits<double>::quiet_NaN()
                                          : std::strtod(row[k].c_str(), nullptr));
      }
      if (!series.x.empty()) plot.series.push_back(std::move(series));
    }
  }
  if (known.empty()) return;
  if (plot.series.empty()) {
    throw SceneError("--plot: no series has a column " + shown(plan.plot) +
                     suggestion(plan.plot, {known.begin(), known.end()}));
  }
  DisplayList list{.width = style::kPage, .height = 0.6 * style::kPage, .title = "lagrain, sweep"};
  add_plot(list, {{0, 0}, {list.width, list.height}}, plot);
  paint_png(list, plan.folder / "plot.png", 300);
  paint_pdf(list, plan.folder / "plot.pdf");
}
#endif

}  // namespace

Variation read_variation(const std::string& text) {
  Variation variation;
  std::string part;
  std::string* now = &variation.key;
  int depth = 0;
  char quote = 0;
  const auto end_value = [&] {
    const auto first = part.find_first_not_of(' ');
    if (first == std::string::npos) {
      throw SceneError("--vary " + shortened(text) +
                       ": expected a key, \"=\" and values, such as law.friction=0.1,0.3,0.5");
    }
    variation.values.push_back(part.substr(first, part.find_last_not_of(' ') - first + 1));
    part.clear();
  };
  for (const char c : text) {
    if (quote != 0) {
      quote = c == quote ? 0 : quote;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    } else if (depth == 0 && c == '=' && now == &variation.key) {
      now = &part;
      continue;
    } else if (depth == 0 && c == ',' && now == &part) {
      end_value();
      continue;
    }
    *now += c;
  }
  end_value();
  return variation;
}

SweepProgress sweep(const SweepPlan& plan, const std::function<bool()>& stop,
                    const std::function<void(const SweepProgress&)>& progress) {
  std::vector<Member> members = members_of(plan);
  make_folder(plan.folder);
  run_all(members, plan, stop, progress);
  write_results(plan, members);
#ifdef LAGRAIN_WITH_RENDER
  draw(plan, members);
#endif
  return progress_of(members);
}

}  // namespace lagrain
