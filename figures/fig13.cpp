// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 13 (report): predicates, and what plain doubles get wrong.
//
// (a), (b) The classical picture of Kettner, Mehlhorn, Pion, Schirra & Yap (Comput. Geom. 40 (2008)
// 61): on which side of a line doubles see the points of a grid of neighbouring doubles, and where
// they are. (c) Share of wrong signs, (d), (e) time of a call, for sites as they occur and for
// degenerate ones.

#include "figure.hpp"
#include "measure.hpp"
#include "predicate_trials.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/plot.hpp>
#include <lagrain/run.hpp>
#include <lagrain/style.hpp>
#include <lagrain/text.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::figures {

namespace {

constexpr int kMapSide = 256;
constexpr int kSites = 512;  // in each set
constexpr std::uint64_t kSeed = 13;
constexpr double kMapWidth = 0.72 * kMapSide;  // three pixels for a double at 300 dpi [pt]

/// The number of calls that are timed: so many that no processor learns their signs by heart.
int calls(bool quick) { return quick ? 800 : 8000; }

enum Way { kPlain, kFiltered, kExact };
using Times = std::array<double, 3>;  ///< of a call, by way [ns]

/// One predicate on one set of sites.
struct Trial {
  std::string predicate;
  Tally tally;
  std::function<Times()> measure;
  Times times{};  ///< medians

  double cost(Way way) const { return times[way] / times[kPlain]; }
};

struct Row {
  std::string sites;
  int dim;
  std::array<Trial, 2> trials;  ///< orientation, power side
};

/// Processor time of a call [ns].
template <class Query, class Sign>
double nanoseconds(std::span<const Query> queries, bool quick, Sign&& sign) {
  static volatile int kept = 0;  // what is computed must be wanted
  const auto pass = [&] {
    int sum = 0;
    for (const Query& query : queries) sum += sign(query);
    kept = kept + sum;
  };
  return 1e9 * bench::seconds_per_call(pass, quick ? 2e-4 : 1e-3) /
         static_cast<double>(queries.size());
}

template <class Predicate>
Trial trial_of(const std::string& name, std::vector<Query<Predicate>> queries, bool quick) {
  const Tally counts = tally<Predicate>(queries);
  return {name, counts, [queries = std::move(queries), quick] {
            // Exact calls are long, so that fewer of them show the same.
            const std::span<const Query<Predicate>> all(queries), some = all.first(all.size() / 8);
            return Times{
                nanoseconds(all, quick, [](const auto& q) { return plain_sign<Predicate>(q); }),
                nanoseconds(all, quick, [](const auto& q) { return filtered_sign<Predicate>(q); }),
                nanoseconds(some, quick,
                            [](const auto& q) { return always_exact_sign<Predicate>(q); })};
          }};
}

template <int Dim>
void add_rows_of(std::vector<Row>& rows, bool quick, const StopCheck& check_stop) {
  for (const TrialSet<Dim>& set : trial_sets<Dim>(kSites)) {
    const auto trial = [&]<class Predicate>(const std::string& name, Predicate) {
      check_stop();
      return trial_of<Predicate>(name, draw_queries<Predicate>(set.sites, calls(quick), kSeed),
                                 quick);
    };
    rows.push_back(
        {set.name,
         Dim,
         {trial("orientation", Orientation<Dim>{}), trial("power side", PowerSide<Dim>{})}});
  }
}

/// Random sites once more, the calls sorted by their sign: what the filter costs when its branch on
/// the sign can be predicted.
template <int Dim>
Row sorted_row(bool quick) {
  const std::vector<Site<Dim>> sites = trial_sets<Dim>(kSites).front().sites;
  const auto sorted = [&]<class Predicate>(const std::string& name, Predicate) {
    std::vector<Query<Predicate>> queries = draw_queries<Predicate>(sites, calls(quick), kSeed);
    std::partition(queries.begin(), queries.end(),
                   [](const auto& q) { return filtered_sign<Predicate>(q) > 0; });
    return trial_of<Predicate>(name, std::move(queries), quick);
  };
  return {"random, sorted by sign",
          Dim,
          {sorted("orientation", Orientation<Dim>{}), sorted("power side", PowerSide<Dim>{})}};
}

/// All trials take turns, so that a machine that slows down slows all of them.
void measure(std::vector<Row>& rows, int turns, const StopCheck& check_stop) {
  std::vector<std::array<std::array<std::vector<double>, 3>, 2>> samples(rows.size());
  for (int turn = 0; turn < turns; ++turn) {
    for (std::size_t k = 0; k < rows.size(); ++k) {
      for (std::size_t t = 0; t < 2; ++t) {
        const Times times = rows[k].trials[t].measure();
        for (std::size_t way = 0; way < 3; ++way) samples[k][t][way].push_back(times[way]);
      }
      check_stop();
    }
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::size_t t = 0; t < 2; ++t) {
      for (std::size_t way = 0; way < 3; ++way) {
        rows[k].trials[t].times[way] = bench::median_of(samples[k][t][way]);
      }
    }
  }
}

double hundredths(int part, int whole) { return 100.0 * part / whole; }

double wrong_share(const Trial& trial) {
  return hundredths(trial.tally.wrong, trial.tally.queries);
}

// ---- Pictures ----------------------------------------------------------------------------------

Colour side_colour(int sign) {
  return sign > 0 ? style::kEdgeNew : sign < 0 ? style::kGrain : style::kInk;
}

void add_map(DisplayList& list, const Vec<2>& low, const OrientationMap& map,
             const std::vector<int>& signs, const std::string& title) {
  Image image{map.side, map.side, {}};
  for (int row = map.side - 1; row >= 0; --row) {  // pictures run downwards
    for (int column = 0; column < map.side; ++column) {
      const Colour c = side_colour(signs[map.index(row, column)]);
      image.rgba.insert(image.rgba.end(), {c.r, c.g, c.b, c.a});
    }
  }
  const Box box{low, low + Vec<2>::Constant(kMapWidth)};
  list.add(Picture{std::move(image), box});
  add_frame(list, box);
  list.add(Label{.text = title, .at = {low[0], box.high[1] + 5}, .size = style::kTitle});
}

void add_map_key(DisplayList& list, const Vec<2>& top_left) {
  constexpr double kSquare = 8, kStep = 13;
  const std::array<std::pair<int, std::string>, 3> key{
      {{1, "left of the line"}, {0, "on it"}, {-1, "right of it"}}};
  Vec<2> at = top_left;
  for (const auto& [sign, text] : key) {
    at[1] -= kStep;
    const Box square{at, at + Vec<2>::Constant(kSquare)};
    list.add(Polygon{corners(square), side_colour(sign), {}});
    add_frame(list, square);
    list.add(Label{.text = text, .at = at + Vec<2>(kSquare + 4, 1.5), .size = style::kSmallText});
  }
  at[1] -= kSquare;
  for (const char* line :
       {"The line runs through", "(12, 12) and (24, 24); column", "$i$ and row $k$ are the point",
        "(0.5 + $i u$, 0.5 + $k u$),", "$u = 2^{-53}$."}) {
    at[1] -= kStep;
    list.add(Label{.text = line, .at = at, .size = style::kSmallText});
  }
}

/// How a mark looks, in rows and key alike.
void add_mark(DisplayList& list, const Vec<2>& at, int style) {
  constexpr double kRadius = 2.4;
  const Colour colour = category(style);
  if (style == 0) {
    list.add(Disc{at, kRadius, style::kPaper, {colour, 1}});
  } else if (style == 1) {
    list.add(Disc{at, kRadius, colour, {}});
  } else {
    const Vec<2> half = Vec<2>::Constant(0.9 * kRadius);
    list.add(Polygon{corners({at - half, at + half}), colour, {}});
  }
}

/// Marks in rows over one logarithmic axis; a row's marks come from a function.
struct RowPanel {
  std::string title, axis;
  std::vector<std::pair<int, std::string>> key;  ///< style of mark, words
  double low, high;
  double room_for_zero;  ///< left of the axis [pt]
  std::function<std::vector<std::pair<int, double>>(const Row&)> marks;
};

void add_row_panel(DisplayList& list, const Box& box, const RowPanel& panel,
                   std::span<const Row> rows, const std::function<double(std::size_t)>& height) {
  const auto at = [&](double value) {
    if (value <= 0) return box.low[0] + 0.5 * panel.room_for_zero;
    const double t = std::log(value / panel.low) / std::log(panel.high / panel.low);
    return box.low[0] + panel.room_for_zero + t * (box.size()[0] - panel.room_for_zero);
  };
  Ticks ticks = log_ticks(panel.low, panel.high, 5);
  if (panel.room_for_zero > 0) {
    const double x = at(panel.low);
    list.add(Segment{{x, box.low[1]}, {x, box.high[1]}, style::kAxisLine});
    ticks.ticks.push_back({0, "0"});
  }
  for (const Tick& tick : ticks.ticks) {
    const double x = at(tick.value);
    list.add(Segment{
        {x, box.low[1]}, {x, box.low[1] - (tick.label.empty() ? 1.5 : 2.5)}, style::kAxisLine});
    list.add(Label{.text = tick.label,
                   .at = {x, box.low[1] - 5},
                   .size = style::kSmallText,
                   .across = Across::centre,
                   .along = Along::top});
    if (tick.label.empty()) continue;
    list.add(Segment{
        {x, box.low[1]}, {x, box.high[1]}, {with_alpha(style::kFaint, 0.4), style::kHairline}});
  }
  list.add(Label{.text = panel.axis,
                 .at = {box.centre()[0], box.low[1] - 15},
                 .size = style::kText,
                 .across = Across::centre,
                 .along = Along::top});
  list.add(Label{.text = panel.title, .at = {box.low[0], box.high[1] + 17}, .size = style::kTitle});
  double x = box.low[0] + 3;
  for (const auto& [style, words] : panel.key) {
    add_mark(list, {x, box.high[1] + 8}, style);
    list.add(Label{.text = words,
                   .at = {x + 5, box.high[1] + 8},
                   .size = style::kSmallText,
                   .along = Along::middle});
    x += 14 + text_extents(words, style::kSmallText).advance;
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double y = height(k);
    list.add(Segment{
        {box.low[0], y}, {box.high[0], y}, {with_alpha(style::kFaint, 0.4), style::kHairline}});
    for (const auto& [style, value] : panel.marks(rows[k])) add_mark(list, {at(value), y}, style);
  }
  add_frame(list, box);
}

/// Shares and times, set by set.
void add_rows(DisplayList& list, const Box& area, std::span<const Row> rows) {
  constexpr double kNames = 104, kGap = 12, kBelow = 26, kAbove = 27;
  const double left = area.low[0] + kNames, bottom = area.low[1] + kBelow;
  const double width = (area.high[0] - 4 - left - 2 * kGap) / 3;
  const double top = area.high[1] - kAbove;
  const double step = (top - bottom) / (static_cast<double>(rows.size()) + 2);
  // A heading above the sets of each dimension.
  const auto height = [&](std::size_t k) {
    return top - step * (static_cast<double>(k) + (rows[k].dim == 2 ? 1.5 : 2.5));
  };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto label = [&](const std::string& text, double x, double y, Colour colour) {
      list.add(Label{.text = text,
                     .at = {x, y},
                     .size = style::kText,
                     .colour = colour,
                     .along = Along::middle});
    };
    if (k == 0 || rows[k].dim != rows[k - 1].dim) {
      label(rows[k].dim == 2 ? "in the plane" : "in space", area.low[0], height(k) + step,
            style::kFaint);
    }
    label(rows[k].sites, area.low[0] + 6, height(k), style::kInk);
  }

  double fastest = 1e300, slowest = 0;
  for (const Row& row : rows) {
    for (const Trial& t : row.trials) {
      fastest = std::min(fastest, *std::min_element(t.times.begin(), t.times.end()));
      slowest = std::max(slowest, *std::max_element(t.times.begin(), t.times.end()));
    }
  }
  const auto times_of = [&](std::size_t trial) {
    return [trial](const Row& row) {
      const Times& t = row.trials[trial].times;
      return std::vector<std::pair<int, double>>{
          {kExact, t[kExact]}, {kFiltered, t[kFiltered]}, {kPlain, t[kPlain]}};
    };
  };
  const auto wrong = [](const Row& row) {
    return std::vector<std::pair<int, double>>{{2, wrong_share(row.trials[1])},
                                               {1, wrong_share(row.trials[0])}};
  };
  const std::vector<std::pair<int, std::string>> ways{
      {kPlain, "double"}, {kFiltered, "filtered"}, {kExact, "exact"}};
  const double low = fastest / 1.5, high = slowest * 1.5;
  const std::array<RowPanel, 3> panels{
      {{"(c) wrong signs of doubles",
        "share of calls [%]",
        {{1, "orientation"}, {2, "power side"}},
        0.5 * hundredths(1, calls(false)),
        50,
        14,
        wrong},
       {"(d) orientation", "time of a call [ns]", ways, low, high, 0, times_of(0)},
       {"(e) power side", "time of a call [ns]", ways, low, high, 0, times_of(1)}}};
  for (std::size_t k = 0; k < panels.size(); ++k) {
    const double x = left + static_cast<double>(k) * (width + kGap);
    add_row_panel(list, {{x, bottom}, {x + width, top}}, panels[k], rows, height);
  }
}

void draw(const OrientationMap& map, std::span<const Row> rows, const FigureOptions& options) {
  constexpr double kRows = 270, kTitle = 16, kGap = 14;
  DisplayList list{.width = style::kPage,
                   .height = kRows + kGap + kMapWidth + kTitle,
                   .title = "lagrain, figure 13"};
  const double y = kRows + kGap;
  add_map(list, {1, y}, map, map.plain, "(a) orientation, in doubles");
  add_map(list, {1 + kMapWidth + kGap, y}, map, map.exact, "(b) the same, exact");
  add_map_key(list, {1 + 2 * (kMapWidth + kGap), y + kMapWidth});
  add_rows(list, {{0, 0}, {style::kPage, kRows}}, rows);
  paint_png(list, options.out / "fig13.png", 300);
  paint_pdf(list, options.out / "fig13.pdf");
}

// ---- Words -------------------------------------------------------------------------------------

/// Two significant digits, large numbers without an exponent.
std::string two_digits(double value) {
  if (value < 100) return rounded(value, 2);
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::to_string(std::lround(std::round(value / unit) * unit));
}

/// "1.2 to 1.4": the range of a quantity over both predicates of the chosen rows.
std::string range_of(const std::vector<Row>& rows, const std::function<bool(const Row&)>& chosen,
                     const std::function<double(const Trial&)>& quantity) {
  double low = 1e300, high = 0;
  for (const Row& row : rows) {
    if (!chosen(row)) continue;
    for (const Trial& t : row.trials) {
      low = std::min(low, quantity(t));
      high = std::max(high, quantity(t));
    }
  }
  const std::string from = two_digits(low), to = two_digits(high);
  return from == to ? from : from + " to " + to;
}

bool is_usual(const Row& row) { return row.sites == "random" || row.sites.starts_with("packing"); }
bool is_sorted(const Row& row) { return row.sites.ends_with("sorted by sign"); }
bool is_on_lattice(const Row& row) {
  return row.sites.ends_with("lattice") || row.sites == "face-centred cubic";
}
bool is_disturbed(const Row& row) { return row.sites.ends_with("off by 1e-6"); }
double filtered_cost(const Trial& trial) { return trial.cost(kFiltered); }
double exact_cost(const Trial& trial) { return trial.cost(kExact); }

std::string caption_of(const std::vector<Row>& rows) {
  return "(a), (b) The side of a line on which doubles see the points of a grid of neighbouring "
         "doubles, and where they are (after Kettner et al., Comput. Geom. 40 (2008) 61). (c) "
         "Share of calls in which doubles without a filter give a wrong sign, for a site and "
         "others of its nearest; (d), (e) processor time of a call in doubles, behind the filter, "
         "and in multiprecision floats alone. Lattices have the pitch 0.1, which no double is. "
         "Lesson: for sites at random and in packings, be they a million radii away from the "
         "origin, a filter costs " +
         range_of(rows, is_usual, filtered_cost) + " times doubles without one (" +
         range_of(rows, is_sorted, filtered_cost) +
         " where calls come sorted by their sign: the rest is the branch on a sign that nobody can "
         "predict, which a caller of plain doubles takes himself), exact arithmetic alone " +
         range_of(rows, is_usual, exact_cost) + " times. On lattices doubles are wrong in " +
         range_of(rows, is_on_lattice, wrong_share) +
         " % of the calls, and the filtered call costs " +
         range_of(rows, is_on_lattice, filtered_cost) +
         " times one in doubles; off by a millionth of the pitch they cost " +
         range_of(rows, is_disturbed, filtered_cost) +
         " times, which is why a run keeps its reference centres a hair's breadth off the grains.";
}

std::vector<Fact> facts_of(const OrientationMap& map, const std::vector<Row>& rows) {
  int wrong = 0, opposite = 0;
  for (std::size_t k = 0; k < map.exact.size(); ++k) {
    wrong += map.plain[k] != map.exact[k];
    opposite += map.plain[k] * map.exact[k] < 0;
  }
  return {
      {"(a): wrong signs", std::to_string(wrong) + " of " + std::to_string(map.exact.size()) +
                               ", " + std::to_string(opposite) + " of them opposite"},
      {"filtered over double, random sites and packings", range_of(rows, is_usual, filtered_cost)},
      {"filtered over double, calls sorted by sign", range_of(rows, is_sorted, filtered_cost)},
      {"filtered over double, lattices", range_of(rows, is_on_lattice, filtered_cost)},
      {"filtered over double, lattices off by a millionth of the pitch",
       range_of(rows, is_disturbed, filtered_cost)},
      {"exact over double, random sites and packings", range_of(rows, is_usual, exact_cost)},
      {"wrong signs of doubles, random sites and packings",
       range_of(rows, is_usual, wrong_share) + " %"},
      {"wrong signs of doubles, lattices", range_of(rows, is_on_lattice, wrong_share) + " %"}};
}

/// Signs and times of all trials as CSV.
std::string csv_of(const std::vector<Row>& rows) {
  Csv csv(
      "dimension,sites,predicate,calls,wrong,opposite,ties,beyond_intervals,double[ns],"
      "filtered[ns],exact[ns]");
  for (const Row& row : rows) {
    for (const Trial& t : row.trials) {
      const Tally& n = t.tally;
      csv.row(row.dim, row.sites, t.predicate, n.queries, n.wrong, n.opposite, n.ties, n.undecided,
              t.times[kPlain], t.times[kFiltered], t.times[kExact]);
    }
  }
  return csv.text();
}

/// Signs and times of all trials for people.
Table table_of(const std::vector<Row>& rows) {
  Table table{"Signs of doubles, and times of a call",
              {"sites", "predicate", "wrong", "opposite", "ties", "beyond intervals", "double [ns]",
               "filtered [ns]", "exact [ns]"},
              {}};
  for (const Row& row : rows) {
    for (const Trial& t : row.trials) {
      const Tally& n = t.tally;
      const auto share = [&](int part) { return percent(hundredths(part, n.queries) / 100, 3); };
      table.rows.push_back({(row.dim == 2 ? "plane: " : "space: ") + row.sites, t.predicate,
                            share(n.wrong), share(n.opposite), share(n.ties), share(n.undecided),
                            two_digits(t.times[kPlain]), two_digits(t.times[kFiltered]),
                            two_digits(t.times[kExact])});
    }
  }
  return table;
}

}  // namespace

FigureResult draw_figure13(const FigureOptions& options) {
  const int turns = options.quick ? 1 : 3;
  double done = 0;
  const StopCheck check_stop = [&] {
    options.check_stop();
    options.progress(std::min(1.0, done++ / (18 * (turns + 2))), "predicates");
  };
  const OrientationMap map = orientation_map(kMapSide);
  std::vector<Row> rows;
  add_rows_of<2>(rows, options.quick, check_stop);
  add_rows_of<3>(rows, options.quick, check_stop);
  const std::size_t shown = rows.size();
  rows.push_back(sorted_row<2>(options.quick));
  rows.push_back(sorted_row<3>(options.quick));
  measure(rows, turns, check_stop);
  draw(map, std::span(rows).first(shown), options);
  write_file(options.out / "fig13_predicates.csv", csv_of(rows));

  FigureResult result;
  result.caption = caption_of(rows);
  result.facts = facts_of(map, rows);
  result.pictures = {"fig13.png", "fig13.pdf"};
  result.downloads = {"fig13_predicates.csv"};
  result.tables = {table_of(rows)};
  return result;
}

}  // namespace lagrain::figures
