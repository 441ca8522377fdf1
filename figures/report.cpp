// SPDX-License-Identifier: GPL-3.0-or-later
#include "report.hpp"

#include "beds.hpp"
#include "lammps.hpp"
#include "page.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>

#ifdef LAGRAIN_WITH_RENDER
#include "diagrams.hpp"
#endif

#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <functional>
#include <optional>
#include <thread>
#include <utility>

namespace lagrain::bench {

namespace {

namespace fs = std::filesystem;

/// A column of a table: what stands above it, and what in it.
struct Column {
  std::string name;  ///< in CSV, with its unit
  std::string head;  ///< on the page
  std::function<double(const SceneSpeed&, const Contender&)> value;
  int digits = 3;
};

double over_triangulation(const SceneSpeed& scene, const Contender& contender) {
  const Contender* ours = scene.find(kTriangulation);
  return ours != nullptr ? ratio(contender, *ours) : kUnknown;
}

const std::vector<Column>& columns() {
  const auto error = [](double RunErrors::*field, double factor = 1) {
    return
        [field, factor](const SceneSpeed&, const Contender& c) { return factor * c.errors.*field; };
  };
  static const std::vector<Column> all{
      {"time[ns/grain/step]", "ns per grain and step",
       [](const SceneSpeed&, const Contender& c) { return c.median(); }},
      {"spread[%]", "spread, %",
       [](const SceneSpeed&, const Contender& c) { return 100 * c.spread(); }, 2},
      {"over_triangulation[-]", "of the triangulation's", over_triangulation},
      {"missed[-]", "contacts missed", error(&RunErrors::missed)},
      {"audited[-]", "of", error(&RunErrors::audited), 9},
      {"dangerous_builds[-]", "dangerous builds", error(&RunErrors::dangerous)},
      {"energy_residual[%]", "energy residual, %", error(&RunErrors::energy_residual, 100), 2},
      {"largest_overlap[%]", "largest overlap, %", error(&RunErrors::largest_overlap, 100)},
      {"mean_overlap[%]", "mean overlap, %", error(&RunErrors::mean_overlap, 100)},
      {"floor_load[-]", "floor carries, of the weight", error(&RunErrors::floor_load), 4},
      {"contacts_per_grain[-]", "contacts per grain", error(&RunErrors::contacts_per_grain)},
      {"near_pairs_per_contact[-]", "near pairs per contact", error(&RunErrors::near_per_contact)},
      {"refreshes_per_1000_steps[-]", "refreshes per 1,000 steps", error(&RunErrors::refreshes)},
      {"kinetic_energy[J]", "kinetic energy, J", error(&RunErrors::kinetic)},
      {"astray[%]", "astray, % of a radius", error(&RunErrors::astray, 100), 2},
  };
  return all;
}

/// The beginning of a row: which scene and who.
void begin_row(Csv& csv, const SceneSpeed& scene, const Contender& contender) {
  csv.word(scene.group);
  csv.word(scene.name);
  csv.number(scene.dimension);
  csv.number(scene.grains);
  csv.word(contender.name);
}
constexpr const char* kRowHead = "group,scene,dimension[-],grains[-],contender";

std::string cell(double value, int digits) {
  return std::isnan(value) ? "" : rounded(value, digits);
}

// The page.

std::string first_line_with(const fs::path& file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M", &local);
  return text.data();
}

std::string load_average() {
  std::ifstream in("/proc/loadavg");
  std::string load;
  in >> load;
  return load.empty() ? "unknown" : load;
}

/// What a reader must know to judge the times.
std::vector<Fact> circumstances(const std::optional<fs::path>& lammps, bool quick) {
  std::vector<Fact> facts{
      {"machine", first_line_with("/proc/cpuinfo", "model name") + ", " +
                      std::to_string(std::thread::hardware_concurrency()) +
                      " cores; every contender uses one"},
      {"load of the machine at the start", load_average()},
      {"compiler", std::string(__VERSION__) + ", flags " + LAGRAIN_BUILD_FLAGS},
      {"lagrain", version()},
      {"LAMMPS", lammps ? lammps_version(*lammps) + ", as installed"
                        : "not found (a program lmp on the path would be measured too)"},
      {"date", today()}};
  if (quick) facts.push_back({"quick", "small scenes and few steps: these times say little"});
  return facts;
}

std::string facts_table(const std::vector<Fact>& facts) {
  std::string html = "<table>\n";
  for (const Fact& fact : facts) {
    html += "<tr><th>" + escaped(fact.name) + "</th><td>" + escaped(fact.value) + "</td></tr>\n";
  }
  return html + "</table>\n";
}

std::vector<std::string> groups_of(const SpeedResults& results) {
  std::vector<std::string> groups;
  for (const SceneSpeed& scene : results.scenes) {
    if (groups.empty() || groups.back() != scene.group) groups.push_back(scene.group);
  }
  return groups;
}

/// The names of all contenders or phases, in the order in which they first come.
template <class List, class F>
std::vector<std::string> names_in(const SpeedResults& results, List list, F name) {
  std::vector<std::string> names;
  for (const SceneSpeed& scene : results.scenes) {
    for (const Contender& contender : scene.contenders) {
      for (const auto& item : list(contender)) {
        if (std::find(names.begin(), names.end(), name(item)) == names.end()) {
          names.push_back(name(item));
        }
      }
    }
  }
  return names;
}
std::vector<std::string> contender_names(const SpeedResults& results) {
  return names_in(
      results, [](const Contender& c) { return std::array<const Contender*, 1>{&c}; },
      [](const Contender* c) { return c->name; });
}
std::vector<std::string> phase_names(const SpeedResults& results) {
  return names_in(
      results, [](const Contender& c) { return c.phases; }, [](const Phase& p) { return p.name; });
}

/// Scenes down, contenders across: times, and how the triangulation compares.
std::string summary_table(const SpeedResults& results) {
  const std::vector<std::string> names = contender_names(results);
  std::string html = "<table>\n<thead><tr><th>ns per grain and step</th>";
  for (const std::string& name : names) html += "<th>" + escaped(name) + "</th>";
  html += "<th>triangulation over oracle</th><th>over LAMMPS</th></tr></thead>\n";
  for (const SceneSpeed& scene : results.scenes) {
    html += "<tr><th>" + escaped(scene.name) + "</th>";
    for (const std::string& name : names) {
      const Contender* contender = scene.find(name);
      html += "<td>" + (contender ? cell(contender->median(), 3) : "") + "</td>";
    }
    const Contender* ours = scene.find(kTriangulation);
    const auto over = [&](const Contender* other) {
      return ours && other ? cell(ratio(*ours, *other), 3) : std::string();
    };
    // Against LAMMPS as it is fastest.
    const Contender* bin = scene.find(kLammps);
    const Contender* multi = scene.find(kLammpsMulti);
    const Contender* best = !bin || (multi && multi->median() < bin->median()) ? multi : bin;
    html += "<td>" + over(scene.find(kOracle)) + "</td><td>" + over(best) + "</td></tr>\n";
  }
  return html + "</table>\n";
}

std::string group_table(const SpeedResults& results, const std::string& group) {
  std::string html = "<table>\n<thead><tr><th>scene</th><th>contender</th>";
  for (const Column& column : columns()) html += "<th>" + escaped(column.head) + "</th>";
  html += "</tr></thead>\n";
  for (const SceneSpeed& scene : results.scenes) {
    if (scene.group != group) continue;
    bool first = true;
    for (const Contender& contender : scene.contenders) {
      html += "<tr><th>" + (first ? escaped(scene.name) : "") + "</th><td>" +
              escaped(contender.name) + "</td>";
      for (const Column& column : columns()) {
        html += "<td>" + cell(column.value(scene, contender), column.digits) + "</td>";
      }
      html += "</tr>\n";
      first = false;
    }
  }
  return html + "</table>\n";
}

std::string phase_table(const SpeedResults& results) {
  const std::vector<std::string> names = phase_names(results);
  std::string html = "<table>\n<thead><tr><th>scene</th><th>contender</th>";
  for (const std::string& name : names) html += "<th>" + escaped(name) + "</th>";
  html += "</tr></thead>\n";
  for (const SceneSpeed& scene : results.scenes) {
    bool first = true;
    for (const Contender& contender : scene.contenders) {
      html += "<tr><th>" + (first ? escaped(scene.name) : "") + "</th><td>" +
              escaped(contender.name) + "</td>";
      for (const std::string& name : names) {
        double ns = kUnknown;
        for (const Phase& phase : contender.phases) {
          if (phase.name == name) ns = phase.ns;
        }
        html += "<td>" + cell(ns, 3) + "</td>";
      }
      html += "</tr>\n";
      first = false;
    }
  }
  return html + "</table>\n";
}

constexpr const char* kHowToRead =
    "Every number on this page comes from one run of the program on the machine named below. On "
    "each scene all contenders get the same state and go through the same steps in several rounds, "
    "a twelfth of a round each in turn, because a machine's moods last a second; times are medians "
    "over the rounds of the processor time of one core, ratios are medians of those of each round, "
    "the spread is the largest time less the smallest, and the errors are those of the first "
    "round. The law is the same everywhere: a linear spring and dashpot, friction with a "
    "tangential spring, coefficient 0.5, frictional walls. The oracle is handed exactly the pairs "
    "that will touch, for nothing: no way to find contacts can be faster. A contender that is "
    "astray by nothing has computed the same bits as the triangulation; where grains collide, "
    "LAMMPS soon follows a path of its own, as any other rounding does. LAMMPS runs "
    "gran/hooke/history with the same stiffness, friction, time step and walls, its dashpots set "
    "alike for grains of median mass, a skin of 0.2 smallest radii and a check for rebuilding at "
    "every step; \"multi\" sorts neighbours by atom type, one for the small and one for the large. "
    "Spheres of one size are the paper's boxes and copies of them side by side.";

#ifdef LAGRAIN_WITH_RENDER

/// One line per contender over what the group varies.
Plot group_plot(const SpeedResults& results, const std::string& group, int dimension, Axis axis) {
  Plot plot{.x = std::move(axis),
            .y = {.label = "time per grain and step [ns]", .log = true},
            .series = {},
            .legend = Corner::top_left};
  int index = 0;
  for (const std::string& name : contender_names(results)) {
    Series series = figures::curve(index++, name);
    for (const SceneSpeed& scene : results.scenes) {
      const Contender* contender = scene.find(name);
      if (scene.group != group || scene.dimension != dimension || contender == nullptr) continue;
      series.x.push_back(scene.parameter);
      series.y.push_back(contender->median());
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  figures::leave_room_for_legend(plot);
  return plot;
}

/// @returns false if the groups to be plotted have not been measured yet
bool draw_plots(const SpeedResults& results, const FigureOptions& options) {
  struct Panel {
    std::string title, group;
    int dimension;
    Axis axis;
  };
  const std::array<Panel, 3> panels{
      {{"(a) number of discs", kGrowthGroup, 2, {.label = "discs", .log = true}},
       {"(b) few large discs among small",
        kSizesGroup,
        2,
        {.label = "ratio of radii", .log = true, .low = 0.7}},
       {"(c) a ball hits a bed at rest", kImpactGroup, 3, {.label = "speed [m/s]"}}}};
  for (const Panel& panel : panels) {
    if (std::none_of(results.scenes.begin(), results.scenes.end(),
                     [&](const SceneSpeed& s) { return s.group == panel.group; })) {
      return false;
    }
  }
  std::vector<figures::Diagram> diagrams;
  for (const Panel& panel : panels) {
    diagrams.push_back(
        {panel.title, group_plot(results, panel.group, panel.dimension, panel.axis)});
  }
  FigureResult pictures;
  figures::draw_diagrams(diagrams, 3, 170, options, "speed", pictures);
  return true;
}

#else

bool draw_plots(const SpeedResults&, const FigureOptions&) { return false; }

#endif

class Report {
 public:
  explicit Report(const FigureOptions& options)
      : options_(options), lammps_(find_lammps()), facts_(circumstances(lammps_, options.quick)) {}

  const std::optional<fs::path>& lammps() const { return lammps_; }

  void write(const SpeedResults& results, bool finished) const {
    write_file(options_.out / "speed.csv", speed_csv(results));
    write_file(options_.out / "speed_rounds.csv", rounds_csv(results));
    write_file(options_.out / "speed_phases.csv", phases_csv(results));
    const bool plots = finished && draw_plots(results, options_);

    std::string html = page_head("lagrain: speed");
    // Wide tables: the page is as wide as the window, its text is not.
    html +=
        "<style>body { max-width: none; } p { max-width: 52rem; }\n"
        "td, th { padding-right: .8rem; } thead th { vertical-align: bottom; }</style>\n";
    html +=
        "<h1>How fast, how accurate</h1>\n<p class=\"note\"><a href=\"report.html\">lagrain</a>" +
        std::string(finished ? "" : "; this run has not come to its end") + "</p>\n";
    html += facts_table(facts_) + "<p>" + escaped(kHowToRead) + "</p>\n" + summary_table(results);
    if (plots) {
      html +=
          "<a href=\"speed.png\"><img src=\"speed.png\" alt=\"Times against the number of "
          "grains, the ratio of sizes and the speed of an impact\"></a>\n";
    }
    for (const std::string& group : groups_of(results)) {
      html += "<article>\n<h2>" + escaped(group) + "</h2>\n" + group_table(results, group) +
              "</article>\n";
    }
    html +=
        "<article>\n<h2>Where the time goes</h2>\n<p>Nanoseconds per grain and step, in the "
        "median round.</p>\n" +
        phase_table(results) + "</article>\n";
    for (const std::string& note : results.notes) html += "<p>" + escaped(note) + "</p>\n";
    html += "<p class=\"links\">";
    std::vector<std::string> files{"speed.csv", "speed_rounds.csv", "speed_phases.csv"};
    if (plots) files.push_back("speed.pdf");
    for (const std::string& file : files) {
      html += "<a href=\"" + page_link(file, options_.out) + "\">" + file + "</a>\n";
    }
    write_file(options_.out / "speed.html", html + "</p>\n</body>\n</html>\n");
    write_index_entry(plots);
  }

 private:
  void write_index_entry(bool plots) const {
    std::string html = "<article id=\"speed\">\n<h2>How fast, how accurate</h2>\n";
    if (plots) {
      html += "<a href=\"speed.html\"><img src=\"speed.png\" alt=\"How fast\"></a>\n";
    }
    html +=
        "<p><a href=\"speed.html\">Times of lagrain and of others on the same beds, beside the "
        "errors of the same runs.</a></p>\n" +
        facts_table(facts_) + "</article>\n";
    write_file(speed_article_file(options_.out), html);
    renew_gallery(all_figures(), options_.out);
  }

  FigureOptions options_;
  std::optional<fs::path> lammps_;
  std::vector<Fact> facts_;
};

}  // namespace

std::string speed_csv(const SpeedResults& results) {
  std::string head = std::string(kRowHead) + ",steps[-],time_step[s]";
  for (const Column& column : columns()) {
    head += ',';
    head += column.name;
  }
  Csv csv(head);
  for (const SceneSpeed& scene : results.scenes) {
    for (const Contender& contender : scene.contenders) {
      begin_row(csv, scene, contender);
      csv.number(scene.steps);
      csv.number(scene.time_step);
      for (const Column& column : columns()) csv.number(column.value(scene, contender));
      csv.end();
    }
  }
  return csv.text();
}

std::string rounds_csv(const SpeedResults& results) {
  Csv csv(std::string(kRowHead) + ",round[-],time[ns/grain/step]");
  for (const SceneSpeed& scene : results.scenes) {
    for (const Contender& contender : scene.contenders) {
      for (std::size_t round = 0; round < contender.ns.size(); ++round) {
        begin_row(csv, scene, contender);
        csv.number(round + 1);
        csv.number(contender.ns[round]);
        csv.end();
      }
    }
  }
  return csv.text();
}

std::string phases_csv(const SpeedResults& results) {
  Csv csv(std::string(kRowHead) + ",phase,time[ns/grain/step]");
  for (const SceneSpeed& scene : results.scenes) {
    for (const Contender& contender : scene.contenders) {
      for (const Phase& phase : contender.phases) {
        begin_row(csv, scene, contender);
        csv.word(phase.name);
        csv.number(phase.ns);
        csv.end();
      }
    }
  }
  return csv.text();
}

void write_speed_report(const FigureOptions& options) {
  make_folder(options.out);
  const Report report(options);
  report.write({}, false);  // a folder that cannot be written shows before the first step
  const SpeedResults results = measure_speed(
      options, report.lammps(), [&](const SpeedResults& so_far) { report.write(so_far, false); });
  report.write(results, true);
}

}  // namespace lagrain::bench
