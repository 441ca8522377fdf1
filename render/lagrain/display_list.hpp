// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What a two-dimensional picture consists of: a list of items in painter's order, later ones on
/// top. A figure is a function from a state to such a list; the painters (paint.hpp) turn the same
/// list into pixels, PDF or SVG. Nothing here knows how anything is drawn.
///
/// Lengths and positions are in points [pt], 1/72 inch, x to the right and y up, the origin at the
/// lower left corner of the page.

#include <lagrain/colormap.hpp>
#include <lagrain/vec.hpp>

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace lagrain {

/// Points per millimetre.
inline constexpr double kPointsPerMm = 72 / 25.4;

/// Axis-parallel rectangle between two corners, low <= high in both coordinates.
struct Box {
  Vec<2> low = Vec<2>::Zero();   ///< lower left corner
  Vec<2> high = Vec<2>::Zero();  ///< upper right corner

  Vec<2> size() const { return high - low; }            ///< width and height
  Vec<2> centre() const { return 0.5 * (low + high); }  ///< its middle
  /// Whether p lies in it, the border included.
  bool contains(const Vec<2>& p) const {
    return low[0] <= p[0] && p[0] <= high[0] && low[1] <= p[1] && p[1] <= high[1];
  }
};

/// Colour of an area that is not filled.
inline constexpr Colour kNoFill{0, 0, 0, 0};

/// How a line is drawn. A width of 0 draws nothing; widths below a pixel become fainter,
/// not thinner.
struct Stroke {
  Colour colour = {};  ///< black unless it says otherwise
  double width = 0;    ///< [pt]
};

/// Disc. The outline is drawn inside, so that the ink ends exactly at the radius.
/// @pre radius >= 0; outline.width <= radius (a wider one is cut to the radius)
struct Disc {
  Vec<2> centre = Vec<2>::Zero();  ///< [pt]
  double radius = 0;               ///< [pt]
  Colour fill = kNoFill;           ///< of the inside
  Stroke outline = {};             ///< none unless it has a width
};

/// Straight line with round caps; the caps reach half a width beyond a and b.
struct Segment {
  Vec<2> a = Vec<2>::Zero();  ///< one end [pt]
  Vec<2> b = Vec<2>::Zero();  ///< the other [pt]
  Stroke stroke = {};         ///< colour and width
};

/// Closed convex polygon, corners in either sense of rotation; the outline is centred on the edges
/// and has round corners. Concave polygons are not supported.
/// @pre at least three corners, convex
struct Polygon {
  std::vector<Vec<2>> corners;  ///< [pt]
  Colour fill = kNoFill;        ///< of the inside
  Stroke outline = {};          ///< none unless it has a width
};

/// Open chain of straight lines with round caps and joins.
/// @pre stroke.colour opaque if the joins shall look alike in every output
struct Polyline {
  std::vector<Vec<2>> points;  ///< [pt]
  Stroke stroke = {};          ///< colour and width
  /// Lengths of dash, gap, dash, gap, ... [pt]; empty is solid. Round caps lengthen a dash by
  /// the width.
  std::vector<double> dashes = {};
};

/// Which part of a label stands at its position, along the line.
enum class Across {
  left,    ///< its beginning
  centre,  ///< its middle
  right,   ///< its end
};
/// Which height of a label stands at its position.
enum class Along {
  baseline,  ///< the baseline passes through the position
  middle,    ///< the middle of a capital letter
  top,       ///< the top of a capital letter
};

/// A line of text in the markup of text.hpp.
struct Label {
  std::string text;               ///< UTF-8, in markup
  Vec<2> at = Vec<2>::Zero();     ///< its position [pt]
  double size = 8;                ///< of the letters [pt]
  Colour colour = {};             ///< of the letters
  Across across = Across::left;   ///< which part stands at the position
  Along along = Along::baseline;  ///< which height does
  double angle = 0;               ///< counter-clockwise about `at` [rad]
};

/// Pixels: RGBA with straight alpha, rows from top to bottom, 4 * width * height bytes.
struct Image {
  int width = 0;                        ///< [px]
  int height = 0;                       ///< [px]
  std::vector<std::uint8_t> rgba = {};  ///< 4 * width * height bytes
};

/// An image stretched over a rectangle. Enlarged pixels stay square, reduced ones are interpolated.
struct Picture {
  Image image;  ///< what is shown
  Box box;      ///< where [pt]
};

/// From here on nothing is drawn outside `box`, nor outside the clips that already hold.
struct PushClip {
  Box box;  ///< [pt]
};
/// Ends the latest clip.
struct PopClip {};

/// Whatever can stand in a list.
using Item = std::variant<Disc, Segment, Polygon, Polyline, Label, Picture, PushClip, PopClip>;

/// A page and what is on it, in painter's order.
struct DisplayList {
  double width = 0;                          ///< of the page [pt]
  double height = 0;                         ///< of the page [pt]
  Colour background = {255, 255, 255, 255};  ///< alpha 0 gives a transparent page
  std::string title = {};                    ///< kept in the PDF's metadata
  std::vector<Item> items = {};              ///< the later ones on top

  /// Puts a Disc, Segment, Polygon, ... on top of what is there.
  template <class T>
  void add(T&& item) {
    items.emplace_back(std::forward<T>(item));
  }
  /// All of the page [pt].
  Box page() const { return {Vec<2>::Zero(), Vec<2>(width, height)}; }
};

/// Maps a rectangle of the world [m] to a rectangle of the page [pt] with equal scales on both
/// axes; what is left over in one direction is shared between the two sides.
class Panel {
 public:
  /// @pre both boxes have positive width and height
  Panel(const Box& page, const Box& world);

  Vec<2> point(const Vec<2>& world) const { return origin_ + scale_ * world; }  ///< [m] -> [pt]
  double length(double metres) const { return scale_ * metres; }                ///< [m] -> [pt]
  double scale() const { return scale_; }                                       ///< [pt/m]
  /// Image of the world rectangle [pt], for clips and frames.
  const Box& box() const { return box_; }

 private:
  double scale_;
  Vec<2> origin_;
  Box box_;
};

/// Corners of a box, counter-clockwise from the lower left.
std::vector<Vec<2>> corners(const Box& box);

/// Cuts a polyline into the solid pieces of its dash pattern. Both painters use it, so that dashes
/// agree in every output.
/// @pre dashes hold no negative length and a positive sum
std::vector<std::vector<Vec<2>>> dashed(const Polyline& line);

}  // namespace lagrain
