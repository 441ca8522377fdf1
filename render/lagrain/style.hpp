// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// One look for all figures: sizes for a journal page, colours that survive grey print.

#include <lagrain/display_list.hpp>

namespace lagrain::style {

inline constexpr double kColumn = 84 * kPointsPerMm;  ///< width of one column [pt]
inline constexpr double kPage = 174 * kPointsPerMm;   ///< width of the full page [pt]
inline constexpr double kText = 8;                    ///< labels, axis names [pt]
inline constexpr double kSmallText = 7;               ///< ticks, legends; nothing is smaller [pt]
inline constexpr double kTitle = 9;                   ///< letters of panels, "(a)" [pt]

inline constexpr double kHairline = 0.3;  ///< outlines of many small grains [pt]
inline constexpr double kThin = 0.5;      ///< axes, cells, edges [pt]
inline constexpr double kMedium = 0.8;    ///< outlines of a few large grains, walls [pt]
inline constexpr double kThick = 1.4;     ///< what the reader should see first [pt]

inline constexpr Colour kInk{34, 34, 34, 255};       ///< text, axes
inline constexpr Colour kFaint{150, 150, 150, 255};  ///< construction lines
inline constexpr Colour kPaper{255, 255, 255, 255};  ///< background

inline constexpr Colour kGrain{214, 223, 232, 255};       ///< fill of a grain
inline constexpr Colour kGrainOutline{62, 84, 107, 255};  ///< its outline
inline constexpr Colour kGrainPale{238, 238, 236, 255};   ///< a grain beneath a force chain
inline constexpr Colour kCell{250, 247, 238, 255};        ///< fill of a cell
inline constexpr Colour kCellOutline{196, 154, 72, 255};  ///< between cells
inline constexpr Colour kEdge{110, 110, 110, 255};        ///< edge of the triangulation
inline constexpr Colour kEdgeNew{0, 114, 178, 255};       ///< edge that appears
inline constexpr Colour kEdgeGone{213, 94, 0, 255};       ///< edge that disappears
inline constexpr Colour kEdgeStale{190, 190, 190, 255};   ///< edge that is out of date
inline constexpr Colour kContact{150, 28, 34, 255};       ///< contacts, force chains
inline constexpr Colour kWall{40, 40, 40, 255};           ///< walls

inline constexpr Stroke kGrainLine{kGrainOutline, kMedium};  ///< around a grain
inline constexpr Stroke kCellLine{kCellOutline, kThin};      ///< around a cell
inline constexpr Stroke kEdgeLine{kEdge, kThin};             ///< edges
inline constexpr Stroke kWallLine{kWall, kThick};            ///< walls
inline constexpr Stroke kAxisLine{kInk, kThin};              ///< axes of plots

}  // namespace lagrain::style
