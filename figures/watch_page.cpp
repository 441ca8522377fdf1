// SPDX-License-Identifier: GPL-3.0-or-later
#include "watch_page.hpp"

#include "page.hpp"

#include <lagrain/check.hpp>
#include <lagrain/files.hpp>
#include <lagrain/numbers.hpp>

#ifdef LAGRAIN_WITH_RENDER
#include "own_picture.hpp"
#endif

#include <algorithm>
#include <cmath>
#include <utility>

namespace lagrain::figures {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kEvery{2};  // at least so long between two states of the page
constexpr int kShare = 50;                 // of the time, at most the inverse goes into the page

std::string row(const std::string& name, const std::string& value) {
  return "<tr><th>" + escaped(name) + "</th><td>" + escaped(value) + "</td></tr>\n";
}

std::string ledger_table(const Ledger& ledger, const Ledger& start) {
  std::string text = "<table><caption>Where the energy is, and where it went</caption>\n";
  for (const auto& [name, value] :
       {std::pair("kinetic", ledger.kinetic), std::pair("gravity", ledger.gravity),
        std::pair("elastic", ledger.elastic), std::pair("put in by walls", ledger.wall_work),
        std::pair("taken by dashpots", ledger.dashpot),
        std::pair("taken by friction", ledger.friction),
        std::pair("brought by grains", ledger.carried),
        std::pair("put in by changing gravity", ledger.gravity_work),
        std::pair("put in by driven grains", ledger.driven_work),
        std::pair("put in by drag", ledger.force_work),
        std::pair("not accounted for", residual(ledger, start))}) {
    if (value != 0) text += row(name, rounded(value, 4) + " J");
  }
  return text + "</table>\n";
}

}  // namespace

template <int Dim>
WatchPage<Dim>::WatchPage(const Run<Dim>& run, std::filesystem::path folder)
    : run_(run), folder_(std::move(folder)) {
#ifndef LAGRAIN_WITH_RENDER
  throw SceneError(
      "--watch: this lagrain was built without its renderer; build it with "
      "-DLAGRAIN_RENDER=ON, or run without --watch");
#endif
}

template <int Dim>
void WatchPage<Dim>::look(const Progress& progress) {
  const auto begin = Clock::now();
  if (begin < due_) return;
  std::string state = fixed(100 * progress.fraction, 0) + " %";
  if (progress.seconds_left > 0)
    state += ", about " + grouped(std::llround(progress.seconds_left)) + " s left";
  write(state, true);
  const auto end = Clock::now();
  // The first picture takes longer than the others: shaders are compiled for it.
  const int share = due_ == Clock::time_point{} ? 1 : kShare;
  due_ = end + std::max<Clock::duration>(kEvery, share * (end - begin));
}

template <int Dim>
void WatchPage<Dim>::end(const std::string& how) {
  write(how, false);
}

template <int Dim>
void WatchPage<Dim>::write(const std::string& state, bool goes_on) const {
  const std::string title = run_.scene().title;
  std::string page = page_head(title);
  if (goes_on) {
    page.insert(page.find("<title>"), "<meta http-equiv=\"refresh\" content=\"" +
                                          std::to_string(kEvery.count()) + "\">\n");
  }
  page += "<h1>" + escaped(title) + "</h1>\n<p>" + escaped(state) + "</p>\n" + pictures();
  const ContactStatistics contacts = run_.statistics();
  page +=
      "<table>\n" +
      row("time", rounded(run_.time(), 4) + " s of " + rounded(run_.scene().duration, 4) + " s") +
      row("steps", grouped(run_.steps())) + row("grains", grouped(run_.count())) +
      row("contacts", grouped(contacts.contacts) + " between grains, " +
                          grouped(contacts.wall_contacts) + " with walls") +
      row("largest overlap", percent(contacts.largest_overlap) + " of the smaller radius") +
      "</table>\n" + ledger_table(run_.ledger(), run_.start()) + "</body>\n</html>\n";
  try {
    write_file(folder_ / "watch.html", page);
  } catch (const SceneError&) {
    // The run itself says what is wrong with the folder.
  }
}

template <int Dim>
std::string WatchPage<Dim>::pictures() const {
#ifdef LAGRAIN_WITH_RENDER
  constexpr double kDpi = 150;
  // Another name each time, or the browser would show what it has kept.
  const std::string version = "?" + std::to_string(run_.steps());
  const auto drawn = [&](const std::string& name, const auto& draw) -> std::string {
    try {
      paint_png(draw().list, folder_ / name, kDpi);
      return "<img src=\"" + name + version + "\" alt=\"" + name + "\">\n";
    } catch (const SceneError& error) {
      return "<p class=\"note\">" + escaped(error.what()) + "</p>\n";
    }
  };
  return drawn("watch.png",
               [&] {
                 const Snapshot<Dim> snapshot = snapshot_of(run_);
                 const PictureWish wish{.subframes = kPreviewSubframes};
                 return picture_of(run_.scene(), snapshot, wish,
                                   scale_of(run_.scene(), snapshot, wish));
               }) +
         drawn("watch_series.png", [&] { return plot_of_series(folder_ / "series.csv", {}); });
#else
  return {};
#endif
}

template class WatchPage<2>;
template class WatchPage<3>;

}  // namespace lagrain::figures
