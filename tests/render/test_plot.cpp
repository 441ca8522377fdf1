// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/plot.hpp>

#include "support.hpp"

#include <lagrain/check.hpp>
#include <lagrain/text.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace lagrain;

namespace {

std::vector<std::string> labels(const Ticks& ticks) {
  std::vector<std::string> out;
  for (const Tick& tick : ticks.ticks) {
    if (!tick.label.empty()) out.push_back(tick.label);
  }
  return out;
}

using Strings = std::vector<std::string>;

}  // namespace

TEST_SUITE("plot") {
  TEST_CASE("ticks stand at round numbers") {
    CHECK(labels(nice_ticks(0, 1, 5)) == Strings{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"});
    CHECK(labels(nice_ticks(0, 10, 5)) == Strings{"0", "2", "4", "6", "8", "10"});
    CHECK(labels(nice_ticks(-1, 1, 4)) == Strings{"$-$1.0", "$-$0.5", "0.0", "0.5", "1.0"});
    CHECK(labels(nice_ticks(97, 103, 3)) == Strings{"98", "100", "102"});
  }

  TEST_CASE("a tick is the double closest to its label") {
    const Ticks ticks = nice_ticks(0, 1, 10);

    REQUIRE(ticks.ticks.size() == 11);
    CHECK(ticks.ticks[3].value == 0.3);
    CHECK(ticks.ticks[7].value == 0.7);
  }

  TEST_CASE("large and small numbers share a power of ten") {
    const Ticks small = nice_ticks(0, 2.4e-4, 5), large = nice_ticks(0, 3e6, 3);

    CHECK(small.exponent == -4);
    CHECK(labels(small) == Strings{"0.0", "0.5", "1.0", "1.5", "2.0"});
    CHECK(large.exponent == 6);
    CHECK(labels(large) == Strings{"0", "1", "2", "3"});
  }

  TEST_CASE("ticks stay inside the range, and there are some, over twenty decades") {
    for (double size = 1e-10; size < 1e10; size *= 3.7) {
      for (const double low : {-0.31 * size, 0.0, 5.03 * size}) {
        for (const int count : {2, 5, 8}) {
          const Ticks ticks = nice_ticks(low, low + size, count);
          CHECK(ticks.ticks.size() >= 2);
          CHECK(ticks.ticks.size() <= static_cast<std::size_t>(std::max(count, 4)) + 1);
          for (const Tick& tick : ticks.ticks) {
            CHECK(tick.value >= low - 1e-9 * size);
            CHECK(tick.value <= low + size * (1 + 1e-9));
          }
        }
      }
    }
  }

  TEST_CASE("logarithmic ticks are powers of ten with minor ticks between") {
    const Ticks ticks = log_ticks(1, 100, 6);

    CHECK(labels(ticks) == Strings{"1", "10", "$10^{2}$"});
    CHECK(ticks.ticks.size() == 19);
    CHECK(labels(log_ticks(1e-8, 1e4, 4)) == Strings{"$10^{-8}$", "$10^{-4}$", "1", "$10^{4}$"});
    CHECK(labels(log_ticks(1.5, 7, 4)) == Strings{"2", "5"});
    CHECK(labels(log_ticks(0.0013, 0.09)) == Strings{"0.002", "0.005", "0.01", "0.02", "0.05"});
    CHECK(labels(log_ticks(3e-6, 3e-5)) ==
          Strings{"$5\\times10^{-6}$", "$10^{-5}$", "$2\\times10^{-5}$"});
  }

  TEST_CASE("labels that would run into each other are left out") {
    for (const double width : {80.0, 110.0, 200.0, 400.0}) {
      DisplayList list{width, 100};
      Plot plot;
      plot.x.log = true;
      plot.series.push_back({"", {3e-6, 3e-5}, {1, 2}});
      add_plot(list, list.page(), plot);
      std::vector<Box> below;
      for (const Item& item : list.items) {
        const auto* label = std::get_if<Label>(&item);
        if (label != nullptr && label->along == Along::top) below.push_back(label_box(*label));
      }
      CHECK(below.size() >= 1);
      for (std::size_t k = 1; k < below.size(); ++k) CHECK(below[k].low[0] > below[k - 1].high[0]);
    }
  }

  TEST_CASE("ranges without length are refused") {
    CHECK_THROWS_AS(nice_ticks(1, 1), ContractError);
    CHECK_THROWS_AS(nice_ticks(0, std::numeric_limits<double>::infinity()), ContractError);
    CHECK_THROWS_AS(log_ticks(0, 1), ContractError);
  }

  TEST_CASE("all of a plot stays inside its area") {
    for (const bool log : {false, true}) {
      Plot plot;
      plot.x = {"time [s]", log, {}, {}};
      plot.y = {"energy $E$ [J]", log, {}, {}};
      for (int s = 0; s < 3; ++s) {
        Series series = series_style(s);
        series.name = "series $s_" + std::to_string(s) + "$";
        for (int k = 1; k < 50; ++k) {
          series.x.push_back(k * 1e-3);
          series.y.push_back(std::exp(0.2 * k * (s + 1)));
        }
        plot.series.push_back(series);
      }
      DisplayList list{300, 200};
      const Box area{{50, 40}, {280, 180}};

      const Box inside = add_plot(list, area, plot);

      CHECK((inside.low - area.low).minCoeff() > 0);
      CHECK((area.high - inside.high).minCoeff() > 0);
      for (const Item& item : list.items) {
        if (const auto* label = std::get_if<Label>(&item)) {
          const Box box = label_box(*label);
          INFO(label->text);
          CHECK(area.contains(box.low));
          CHECK(area.contains(box.high));
          CHECK(label->size >= 7);
        }
      }
    }
  }

  TEST_CASE("a value that cannot be shown interrupts the line") {
    Plot plot;
    plot.series.push_back({"", {0, 1, 2, 3, 4}, {0, 1, std::nan(""), 1, 0}});
    DisplayList list{200, 200};

    add_plot(list, list.page(), plot);

    CHECK(std::count_if(list.items.begin(), list.items.end(), [](const Item& item) {
            return std::holds_alternative<Polyline>(item);
          }) == 2);
  }

  TEST_CASE("a plot without data, or with columns of unequal length, is refused") {
    DisplayList list{200, 200};
    Plot plot;

    CHECK_THROWS_AS(add_plot(list, list.page(), plot), ContractError);
    plot.series.push_back({"", {0, 1}, {0}});
    CHECK_THROWS_AS(add_plot(list, list.page(), plot), ContractError);
  }

  TEST_CASE("series differ in more than colour") {
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < a; ++b) CHECK(series_style(a).dashes != series_style(b).dashes);
    }
  }

  TEST_CASE("the samples of a width legend have the width of their values") {
    DisplayList list{200, 50};
    const std::vector<double> values{1, 5, 20};

    const Box box = add_width_legend(list, {10, 30}, values, 0.2, "N");

    std::vector<double> widths;
    for (const Item& item : list.items) {
      if (const auto* sample = std::get_if<Segment>(&item)) widths.push_back(sample->stroke.width);
      if (const auto* label = std::get_if<Label>(&item)) {
        CHECK(box.contains(label_box(*label).low));
        CHECK(box.contains(label_box(*label).high));
      }
    }
    CHECK(widths == std::vector<double>{0.2, 1, 4});
  }
}
