// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Plots in rows on a page, as the report's diagrams have them.

#include "figure.hpp"

#include <lagrain/plot.hpp>

#include <numbers>
#include <string>
#include <vector>

namespace lagrain::figures {

/// A plot and what stands above it: "(a) bouncing disc".
struct Diagram {
  std::string title;
  Plot plot;
};

/// An angle [rad] as diagrams have it.
inline double degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// Colour, dashes and marker of the index-th curve of a diagram.
Series curve(int index, const std::string& name);

/// An empty diagram of an error against the processor time that it costs, both logarithmic.
/// @param error  its name, and what it is a part of
Diagram error_diagram(const std::string& title, const std::string& error, Corner legend);

/// Widens the range of y, so that the legend in an upper corner covers no curve and a range exists
/// even where all points agree.
void leave_room_for_legend(Plot& plot);

/// Draws the diagrams in rows of so many, each of the given height [pt], into NAME.png and
/// NAME.pdf, and lists these among the result's pictures.
void draw_diagrams(const std::vector<Diagram>& diagrams, int columns, double height,
                   const FigureOptions& options, const std::string& name, FigureResult& result);

}  // namespace lagrain::figures
