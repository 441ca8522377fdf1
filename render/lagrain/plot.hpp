// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Plots, colour bars and legends. They only add items to a display list.

#include <lagrain/display_list.hpp>
#include <lagrain/style.hpp>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lagrain {

/// A tick and what stands beside it, in the markup of text.hpp.
struct Tick {
  double value = 0;   ///< in the axis' unit
  std::string label;  ///< empty for a minor tick
};

/// Ticks of one axis, and the power of ten that their labels leave out.
struct Ticks {
  std::vector<Tick> ticks;  ///< in increasing order
  int exponent = 0;         ///< a label times 10^exponent is the value
};

/// Multiples of 1, 2 or 5 times a power of ten inside [low, high]: at least two, at most
/// about `count`.
/// @pre low < high, both finite; count >= 2
Ticks nice_ticks(double low, double high, int count = 6);

/// Powers of ten inside [low, high], labelled as such, thinned when there are many; minor ticks at
/// 2, 3, ... 9 when the range is short. A range without two powers of ten gets labels at 1, 2
/// and 5.
/// @pre 0 < low < high
Ticks log_ticks(double low, double high, int count = 6);

/// Shape at each point of a series, so that series differ in grey print too.
enum class Marker {
  none,      ///< the line alone
  disc,      ///< a filled circle
  square,    ///< a filled square
  triangle,  ///< a filled triangle
  diamond,   ///< a square on its corner
  ring,      ///< a circle without filling
};

/// A curve, points, or both.
struct Series {
  std::string name;       ///< for the legend; empty: not listed
  std::vector<double> x;  ///< in the axis' unit, shape N
  std::vector<double> y;  ///< N; a NaN, or a value <= 0 on a logarithmic axis, interrupts the line
  Colour colour = style::kInk;      ///< of line and markers
  double width = 1.0;               ///< [pt]; 0: markers only
  std::vector<double> dashes = {};  ///< [pt], as in Polyline
  Marker marker = Marker::none;     ///< at each point
};

/// Colour, width and dashes of the index-th series of a plot, distinguishable without colour.
Series series_style(int index);

/// An axis of a plot.
struct Axis {
  std::string label;                ///< with its unit: "time [s]"
  bool log = false;                 ///< logarithmic
  std::optional<double> low = {};   ///< where it begins; if missing, where the data do
  std::optional<double> high = {};  ///< where it ends; if missing, where the data do
};

/// Where a legend stands.
enum class Corner { top_left, top_right, bottom_left, bottom_right, none };

/// Series against two axes.
struct Plot {
  Axis x;                             ///< the horizontal axis
  Axis y;                             ///< the vertical axis
  std::vector<Series> series;         ///< the later ones on top
  Corner legend = Corner::top_right;  ///< none: no legend
};

/// Adds a plot that fills `area`, tick labels and axis names included.
/// @return the box inside the axes [pt], to line up with other panels
/// @pre every series has as many x as y; there is something to show on each axis
Box add_plot(DisplayList& list, const Box& area, const Plot& plot);

/// Adds a vertical colour bar with ticks on its right, and its name above.
/// @param bar  the coloured rectangle [pt]; ticks need about 25 pt to its right
/// @pre low < high
void add_colour_bar(DisplayList& list, const Box& bar, ColourMap map, double low, double high,
                    const std::string& label);

/// Adds a legend of line widths: one sample line for each value, with its number below.
/// @param at      left end of the legend, on the middle of the sample lines [pt]
/// @param values  e.g. three forces
/// @param width   points of line width per unit of value
/// @param unit    e.g. "kN"; also in markup
/// @return the box that the legend covers [pt]
Box add_width_legend(DisplayList& list, const Vec<2>& at, std::span<const double> values,
                     double width, const std::string& unit, Colour colour = style::kContact);

/// Adds a bar that shows a length of the world, with its number, e.g. "5 cm" for 0.05 m.
/// @param at left end [pt]
void add_scale_bar(DisplayList& list, const Vec<2>& at, const Panel& panel, double metres,
                   const std::string& label);

/// Adds the outline of a box.
void add_frame(DisplayList& list, const Box& box, const Stroke& stroke = style::kAxisLine);

}  // namespace lagrain
