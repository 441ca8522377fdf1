// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/plot.hpp>

#include <lagrain/check.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/text.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace lagrain {
namespace {

constexpr double kTickLength = 2.5;  // [pt]
constexpr double kGap = 2.5;         // between a tick and its label, and so on [pt]
// Room that a tick with its label takes, along a horizontal and a vertical axis [pt].
constexpr double kTickWidth = 40, kTickHeight = 22;

// As many ticks as there is room for, but not so many that an axis becomes a ruler.
int tick_count(double length, double each) {
  return std::clamp(static_cast<int>(length / each), 2, 8);
}

// A number in the markup of labels. Minus signs need mathematics; digits look alike in both fonts.
std::string number(double value, int decimals) {
  const std::string text = fixed(value, decimals);
  return text[0] == '-' ? "$-$" + text.substr(1) : text;
}

// The shortest decimal form with at most six decimals.
std::string plain(double value) {
  for (int decimals = 0; decimals < 6; ++decimals) {
    const double factor = std::pow(10, decimals);
    if (std::abs(value * factor - std::round(value * factor)) < 1e-9 * std::abs(value * factor)) {
      return number(value, decimals);
    }
  }
  return number(value, 6);
}

// "$<before>10^{exponent}$"
std::string power_of_ten(int exponent, const std::string& before = {}) {
  return std::string("$")
      .append(before)
      .append("10^{")
      .append(std::to_string(exponent))
      .append("}$");
}

bool shown(double value, const Axis& axis) {
  return std::isfinite(value) && (!axis.log || value > 0);
}

// Maps values in the axis' unit to the page, along one direction.
struct Scale {
  double low, high;  // range of values
  double from, to;   // on the page [pt]
  bool log;

  double at(double value) const {
    const double t =
        log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    return from + t * (to - from);
  }
  bool holds(double value) const {
    const double slack = 1e-9 * (high - low);
    return log ? value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9)
               : value >= low - slack && value <= high + slack;
  }
};

void range(const Axis& axis, const std::vector<Series>& all, std::vector<double> Series::*values,
           double& low, double& high) {
  low = std::numeric_limits<double>::infinity();
  high = -low;
  for (const Series& series : all) {
    for (std::size_t k = 0; k < series.x.size(); ++k) {
      const double value = (series.*values)[k];
      if (!shown(value, axis)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  LAGRAIN_EXPECTS(low <= high || (axis.low && axis.high),
                  "add_plot: nothing to show on the axis \"" + axis.label + "\"");
  if (!(low <= high)) low = high = *axis.low;
  // A little air, so that curves do not touch the frame.
  if (axis.log) {
    const double air = low < high ? std::pow(high / low, 0.04) : 2;
    low /= air, high *= air;
  } else {
    const double air = low < high ? 0.04 * (high - low) : std::max(std::abs(low), 1.0) / 2;
    low -= air, high += air;
  }
  if (axis.low) low = *axis.low;
  if (axis.high) high = *axis.high;
  LAGRAIN_EXPECTS(low < high && (!axis.log || low > 0), "add_plot: range " + std::to_string(low) +
                                                            " to " + std::to_string(high) +
                                                            " of the axis \"" + axis.label + "\"");
}

void add_marker(DisplayList& list, const Vec<2>& p, const Series& series) {
  const double r = 1.4 + 0.6 * series.width;
  const Stroke line{series.colour, 0.7};
  const auto polygon = [&](std::initializer_list<Vec<2>> directions) {
    Polygon out{{}, series.colour, {}};
    for (const Vec<2>& d : directions) out.corners.push_back(p + r * d);
    list.add(out);
  };
  switch (series.marker) {
    case Marker::none:
      break;
    case Marker::disc:
      list.add(Disc{p, r, series.colour, {}});
      break;
    case Marker::ring:
      list.add(Disc{p, r, style::kPaper, line});
      break;
    case Marker::square:
      polygon({{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0.9}, {-0.9, 0.9}});
      break;
    case Marker::triangle:
      polygon({{-1.1, -0.7}, {1.1, -0.7}, {0.0, 1.2}});
      break;
    case Marker::diamond:
      polygon({{-1.25, 0.0}, {0.0, -1.25}, {1.25, 0.0}, {0.0, 1.25}});
      break;
  }
}

void add_series(DisplayList& list, const Series& series, const Plot& plot, const Scale& x,
                const Scale& y) {
  Polyline line{{}, {series.colour, series.width}, series.dashes};
  std::vector<Vec<2>> marks;
  const auto end_piece = [&] {
    if (line.points.size() > 1 && series.width > 0) list.add(line);
    line.points.clear();
  };
  for (std::size_t k = 0; k < series.x.size(); ++k) {
    if (!shown(series.x[k], plot.x) || !shown(series.y[k], plot.y)) {
      end_piece();
      continue;
    }
    const Vec<2> p(x.at(series.x[k]), y.at(series.y[k]));
    line.points.push_back(p);
    marks.push_back(p);
  }
  end_piece();
  if (series.marker != Marker::none) {
    for (const Vec<2>& p : marks) add_marker(list, p, series);
  }
}

void add_legend(DisplayList& list, const Box& inside, const Plot& plot) {
  constexpr double kSample = 20, kRow = 1.35 * style::kSmallText, kMargin = 4;
  double width = 0;
  int rows = 0;
  for (const Series& series : plot.series) {
    if (series.name.empty()) continue;
    ++rows;
    width = std::max(width, text_extents(series.name, style::kSmallText).advance);
  }
  if (rows == 0 || plot.legend == Corner::none) return;
  width += kSample + 3 * kMargin;
  const double height = rows * kRow + kMargin;
  const bool left = plot.legend == Corner::top_left || plot.legend == Corner::bottom_left;
  const bool top = plot.legend == Corner::top_left || plot.legend == Corner::top_right;
  const Vec<2> low(left ? inside.low[0] + kMargin : inside.high[0] - kMargin - width,
                   top ? inside.high[1] - kMargin - height : inside.low[1] + kMargin);
  // A translucent ground keeps the legend readable where a curve passes beneath.
  list.add(
      Polygon{corners({low, low + Vec<2>(width, height)}), with_alpha(style::kPaper, 0.85), {}});
  double y = low[1] + height - 0.5 * kMargin - 0.5 * kRow;
  for (const Series& series : plot.series) {
    if (series.name.empty()) continue;
    const double x0 = low[0] + kMargin, x1 = x0 + kSample;
    if (series.width > 0) {
      list.add(Polyline{{{x0, y}, {x1, y}}, {series.colour, series.width}, series.dashes});
    }
    add_marker(list, {0.5 * (x0 + x1), y}, series);
    list.add(Label{series.name,
                   {x1 + kMargin, y},
                   style::kSmallText,
                   style::kInk,
                   Across::left,
                   Along::middle});
    y -= kRow;
  }
}

}  // namespace

Ticks nice_ticks(double low, double high, int count) {
  LAGRAIN_EXPECTS(std::isfinite(low) && std::isfinite(high) && low < high && count >= 2,
                  "nice_ticks: from " + std::to_string(low) + " to " + std::to_string(high));
  // The smallest step of 1, 2 or 5 times a power of ten that gives no more than `count` intervals;
  // a smaller one if the range happens to lie between two of its ticks.
  const double rough = (high - low) / count;
  int decade = static_cast<int>(std::floor(std::log10(rough)));
  const double lead = rough / std::pow(10, decade);
  double digit = lead <= 1.0000001 ? 1 : lead <= 2.0000001 ? 2 : 5;
  if (lead > 5.0000001) digit = 1, ++decade;
  double step = digit * std::pow(10, decade);
  while (std::floor(high / step + 1e-9) - std::ceil(low / step - 1e-9) < 1) {
    if (digit == 1) --decade;
    digit = digit == 1 ? 5 : digit == 2 ? 1 : 2;
    step = digit * std::pow(10, decade);
  }

  Ticks out;
  const double largest = std::max(std::abs(low), std::abs(high));
  const int top = static_cast<int>(std::floor(std::log10(largest)));
  if (top >= 5 || top <= -3) out.exponent = top;  // 100000 and 0.001 are tiresome to read
  const int decimals = std::max(0, out.exponent - decade);
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) {
    // From integers, so that 3 steps of 0.1 are the number closest to 0.3.
    const double value = decade < 0 ? k * digit / std::pow(10, -decade) : k * step;
    out.ticks.push_back({value, number(value / std::pow(10, out.exponent), decimals)});
  }
  return out;
}

Ticks log_ticks(double low, double high, int count) {
  LAGRAIN_EXPECTS(0 < low && low < high && std::isfinite(high) && count >= 2,
                  "log_ticks: from " + std::to_string(low) + " to " + std::to_string(high));
  const int first = static_cast<int>(std::floor(std::log10(low) + 1e-9));
  const int last = static_cast<int>(std::floor(std::log10(high) + 1e-9));
  const int lowest_power = static_cast<int>(std::ceil(std::log10(low) - 1e-9));
  const int powers = last - lowest_power + 1;
  const int stride = std::max(1, (powers + count - 1) / count);
  Ticks out;
  for (int e = first; e <= last; ++e) {
    for (int m = 1; m <= 9; ++m) {
      if (m > 1 && 10 * powers > 7 * count) break;
      const double value = e < 0 ? m / std::pow(10, -e) : m * std::pow(10, e);
      if (value < low * (1 - 1e-9) || value > high * (1 + 1e-9)) continue;
      std::string label;
      if (powers < 2 && (m == 1 || m == 2 || m == 5)) {
        label = e >= -3 && e <= 3 ? plain(value)
                : m == 1          ? power_of_ten(e)
                                  : power_of_ten(e, std::to_string(m) + "\\times");
      } else if (m == 1 && (e - lowest_power) % stride == 0) {
        label = e == 0 ? "1" : e == 1 ? "10" : power_of_ten(e);
      }
      out.ticks.push_back({value, label});
    }
  }
  return out;
}

Series series_style(int index) {
  static const std::array<std::vector<double>, 4> dashes{
      {{}, {4.5, 2.2}, {0.2, 2.2}, {5, 2.2, 0.2, 2.2}}};
  static constexpr std::array<double, 4> widths{1.1, 1.0, 1.4, 0.9};
  const auto k = static_cast<std::size_t>((index % 4 + 4) % 4);
  Series out;
  out.colour = category(index);
  out.dashes = dashes[k];
  out.width = widths[k];
  return out;
}

Box add_plot(DisplayList& list, const Box& area, const Plot& plot) {
  for (const Series& series : plot.series) {
    LAGRAIN_EXPECTS(series.x.size() == series.y.size(),
                    "add_plot: series \"" + series.name + "\" has " +
                        std::to_string(series.x.size()) + " x and " +
                        std::to_string(series.y.size()) + " y");
  }
  Scale x{0, 1, 0, 1, plot.x.log}, y{0, 1, 0, 1, plot.y.log};
  range(plot.x, plot.series, &Series::x, x.low, x.high);
  range(plot.y, plot.series, &Series::y, y.low, y.high);
  const Vec<2> size = area.size();
  const Ticks xt = (x.log ? log_ticks : nice_ticks)(x.low, x.high, tick_count(size[0], kTickWidth));
  const Ticks yt =
      (y.log ? log_ticks : nice_ticks)(y.low, y.high, tick_count(size[1], kTickHeight));

  // The text that has to fit decides on the margins.
  double y_labels = 0, last_x = 0;
  for (const Tick& tick : yt.ticks) {
    y_labels = std::max(y_labels, text_extents(tick.label, style::kSmallText).advance);
  }
  for (const Tick& tick : xt.ticks) {
    last_x = std::max(last_x, 0.5 * text_extents(tick.label, style::kSmallText).advance);
  }
  const double name = 1.25 * style::kText;          // a line
  const double x_name = name + 0.3 * style::kText;  // a line and its descenders
  const double left =
      kTickLength + 2 * kGap + y_labels + (plot.y.label.empty() ? 0 : 1.35 * style::kText);
  const double bottom =
      kTickLength + kGap + kCapHeight * style::kSmallText + (plot.x.label.empty() ? 1 : x_name);
  const double top = yt.exponent != 0 ? 1.6 * style::kSmallText : 0.5 * style::kSmallText;
  Box inside{area.low + Vec<2>(left, bottom), area.high - Vec<2>(std::max(last_x, 3.0), top)};
  LAGRAIN_EXPECTS(inside.size().minCoeff() > 0, "add_plot: the area is too small for its labels");
  x.from = inside.low[0], x.to = inside.high[0];
  y.from = inside.low[1], y.to = inside.high[1];

  list.add(PushClip{inside});
  for (const Series& series : plot.series) add_series(list, series, plot, x, y);
  list.add(PopClip{});

  add_frame(list, inside);
  const auto tick_length = [](const Tick& tick) {
    return tick.label.empty() ? 0.6 * kTickLength : kTickLength;
  };
  double taken = area.low[0] - inside.size()[0];  // by labels so far, from the left
  for (const Tick& tick : xt.ticks) {
    if (!x.holds(tick.value)) continue;
    const Vec<2> p(x.at(tick.value), inside.low[1]);
    list.add(Segment{p, p - Vec<2>(0, tick_length(tick)), style::kAxisLine});
    const double half = 0.5 * text_extents(tick.label, style::kSmallText).advance;
    if (tick.label.empty() || p[0] - half < taken + kGap) continue;
    taken = p[0] + half;
    list.add(Label{tick.label, p - Vec<2>(0, kTickLength + kGap), style::kSmallText, style::kInk,
                   Across::centre, Along::top});
  }
  for (const Tick& tick : yt.ticks) {
    if (!y.holds(tick.value)) continue;
    const Vec<2> p(inside.low[0], y.at(tick.value));
    list.add(Segment{p, p - Vec<2>(tick_length(tick), 0), style::kAxisLine});
    if (tick.label.empty()) continue;
    list.add(Label{tick.label, p - Vec<2>(kTickLength + kGap, 0), style::kSmallText, style::kInk,
                   Across::right, Along::middle});
  }
  if (xt.exponent != 0) {
    list.add(Label{power_of_ten(xt.exponent, "\\times"),
                   {inside.high[0], area.low[1] + 0.3 * style::kText},
                   style::kSmallText,
                   style::kInk,
                   Across::right});
  }
  if (yt.exponent != 0) {
    list.add(Label{power_of_ten(yt.exponent, "\\times"),
                   {inside.low[0], inside.high[1] + kGap},
                   style::kSmallText,
                   style::kInk});
  }
  if (!plot.x.label.empty()) {
    list.add(Label{plot.x.label,
                   {inside.centre()[0], area.low[1] + 0.3 * style::kText},
                   style::kText,
                   style::kInk,
                   Across::centre});
  }
  if (!plot.y.label.empty()) {
    list.add(Label{plot.y.label,
                   {area.low[0] + style::kText, inside.centre()[1]},
                   style::kText,
                   style::kInk,
                   Across::centre,
                   Along::baseline,
                   std::numbers::pi / 2});
  }
  add_legend(list, inside, plot);
  return inside;
}

void add_colour_bar(DisplayList& list, const Box& bar, ColourMap map, double low, double high,
                    const std::string& label) {
  Image image{1, 256, {}};
  for (int k = 255; k >= 0; --k) {
    const Colour c = colour(map, k / 255.0);
    image.rgba.insert(image.rgba.end(), {c.r, c.g, c.b, c.a});
  }
  list.add(Picture{image, bar});
  add_frame(list, bar);
  const Ticks ticks = nice_ticks(low, high, tick_count(bar.size()[1], kTickHeight));
  for (const Tick& tick : ticks.ticks) {
    const double y = bar.low[1] + (tick.value - low) / (high - low) * bar.size()[1];
    list.add(Segment{{bar.high[0], y}, {bar.high[0] + kTickLength, y}, style::kAxisLine});
    list.add(Label{tick.label,
                   {bar.high[0] + kTickLength + kGap, y},
                   style::kSmallText,
                   style::kInk,
                   Across::left,
                   Along::middle});
  }
  std::string name = label;
  if (ticks.exponent != 0) name.append(" ").append(power_of_ten(ticks.exponent, "\\times"));
  list.add(Label{name, {bar.low[0], bar.high[1] + 2 * kGap}, style::kSmallText, style::kInk});
}

Box add_width_legend(DisplayList& list, const Vec<2>& at, std::span<const double> values,
                     double width, const std::string& unit, Colour colour) {
  LAGRAIN_EXPECTS(!values.empty() && width > 0, "add_width_legend: nothing to show");
  constexpr double kSample = 16, kSpace = 8;
  double x = at[0], thickest = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::string text = plain(values[k]) + (k + 1 == values.size() ? " " + unit : "");
    thickest = std::max(thickest, width * values[k]);
    const double advance = text_extents(text, style::kSmallText).advance;
    const double half = 0.5 * std::max(kSample + width * values[k], advance);
    list.add(Segment{{x + half - 0.5 * kSample, at[1]},
                     {x + half + 0.5 * kSample, at[1]},
                     {colour, width * values[k]}});
    list.add(Label{text,
                   {x + half, at[1] - 0.5 * width * values[k] - kGap},
                   style::kSmallText,
                   style::kInk,
                   Across::centre,
                   Along::top});
    x += 2 * half + kSpace;
  }
  // The numbers stand on one line, below the thickest sample.
  for (std::size_t k = list.items.size() - 2 * values.size(); k < list.items.size(); ++k) {
    if (auto* text = std::get_if<Label>(&list.items[k]))
      text->at[1] = at[1] - 0.5 * thickest - kGap;
  }
  return {{at[0], at[1] - 0.5 * thickest - kGap - style::kSmallText},
          {x - kSpace, at[1] + 0.5 * thickest}};
}

void add_scale_bar(DisplayList& list, const Vec<2>& at, const Panel& panel, double metres,
                   const std::string& label) {
  const Vec<2> end = at + Vec<2>(panel.length(metres), 0);
  const Vec<2> tick(0, kTickLength);
  list.add(Segment{at, end, {style::kInk, style::kMedium}});
  list.add(Segment{at - tick, at + tick, {style::kInk, style::kMedium}});
  list.add(Segment{end - tick, end + tick, {style::kInk, style::kMedium}});
  list.add(Label{label, 0.5 * (at + end) + Vec<2>(0, kGap), style::kSmallText, style::kInk,
                 Across::centre});
}

void add_frame(DisplayList& list, const Box& box, const Stroke& stroke) {
  list.add(Polygon{corners(box), kNoFill, stroke});
}

}  // namespace lagrain
