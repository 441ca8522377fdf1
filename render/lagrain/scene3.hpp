// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What a picture of a three-dimensional scene consists of: balls, tubes, lines, panes, a camera
/// and lights. A figure is a function from a state to such a scene; paint_scene3 (paint.hpp) turns
/// it into pixels, which a display list carries as a Picture beneath its vector labels. Nothing
/// here knows how anything is drawn.
///
/// Positions and lengths are in metres [m], in a right-handed frame, z usually up. Widths of lines
/// are in points [pt], 1/72 inch.

#include <lagrain/display_list.hpp>
#include <lagrain/style.hpp>

#include <array>
#include <optional>
#include <vector>

namespace lagrain {

/// Axis-parallel box between two corners, low <= high in all coordinates [m].
struct Box3 {
  Vec<3> low = Vec<3>::Zero();   ///< corner with the least coordinates
  Vec<3> high = Vec<3>::Zero();  ///< corner with the greatest

  Vec<3> size() const { return high - low; }            ///< lengths of its edges
  Vec<3> centre() const { return 0.5 * (low + high); }  ///< its middle
};

/// Sphere. @pre radius >= 0
struct Ball {
  Vec<3> centre = Vec<3>::Zero();  ///< [m]
  double radius = 0;               ///< [m]
  Colour colour = style::kGrain;   ///< drawn opaque
};

/// Cylinder with round ends, which reach a radius beyond from and to. @pre radius >= 0
struct Tube {
  Vec<3> from = Vec<3>::Zero();     ///< one end of the axis [m]
  Vec<3> to = Vec<3>::Zero();       ///< the other [m]
  double radius = 0;                ///< [m]
  Colour colour = style::kContact;  ///< drawn opaque
};

/// Straight line of constant width on the page, hidden by what is in front of it; not lit, not cut,
/// casts no shadow. Drawn opaque and at least one pixel wide.
struct Line3 {
  Vec<3> a = Vec<3>::Zero();         ///< one end [m]
  Vec<3> b = Vec<3>::Zero();         ///< the other [m]
  Stroke stroke = style::kEdgeLine;  ///< [pt]
};

/// Translucent plane convex quadrilateral, e.g. a wall of glass: tints what is behind it; not lit,
/// not cut, casts no shadow. Panes that cross each other are laid over each other by the distance
/// of their middles.
struct Pane {
  std::array<Vec<3>, 4> corners;        ///< in either sense of rotation [m]
  Colour colour = {120, 150, 180, 30};  ///< alpha is the share of the tint
};

/// Horizontal or inclined floor that is seen only by the shadows that fall on it: exactly the
/// background's colour where no light is missing, invisible from below.
struct Floor {
  double height = 0;                ///< along the normal, from the origin [m]
  Vec<3> normal = Vec<3>(0, 0, 1);  ///< upwards [-], of any length > 0
};

/// The half-space normal . x > offset is taken out of balls and tubes; where it cuts them they are
/// closed by a flat, unlit face in a slightly darker colour. Several cuts take out their union.
struct Cut {
  Vec<3> normal = Vec<3>(0, 1, 0);  ///< [-], of any length > 0
  double offset = 0;                ///< normal . x on the plane, [m] for a unit normal
};

/// Where the picture is taken from.
struct Camera {
  Vec<3> eye = Vec<3>(0, -1, 0);   ///< [m]
  Vec<3> target = Vec<3>::Zero();  ///< what is in the middle of the picture [m]
  Vec<3> up = Vec<3>(0, 0, 1);     ///< points up on the page; not along the line of sight
  double height = 1;               ///< of the picture, measured at the target [m]
  bool perspective = false;        ///< false: parallel lines of sight
};

/// Unit vectors of the page as rows: right, up, towards the viewer.
/// @throws ContractError if the eye is at the target, or up along the line of sight
Eigen::Matrix3d page_axes(const Camera& camera);

/// A camera that frames a box as tightly as it can from a given side.
/// @param direction     from the viewer towards the box [-]; (0, 0, 1) looks up from below
/// @param up            points up on the page; for a view from above or below (0, 1, 0) will do
/// @param aspect        width of the picture over its height [-]
/// @param field_of_view vertical angle of a perspective picture [rad]; 0: parallel lines of sight
/// @param margin        left free on each side, as a share of the picture's size [-]
/// @pre the box is not a point; aspect > 0; 0 <= field_of_view < pi; 0 <= margin < 0.5
Camera camera_framing(const Box3& box, const Vec<3>& direction, const Vec<3>& up = {0, 0, 1},
                      double aspect = 1, double field_of_view = 0, double margin = 0.03);

/// A sun, which casts shadows with soft borders, and a sky above, which reaches into gaps the less
/// the deeper they are.
struct Lights {
  Vec<3> sun = Vec<3>(-0.45, -0.6, 0.9);  ///< direction towards the sun [-], any length > 0
  Vec<3> zenith = Vec<3>(0, 0, 1);        ///< towards the middle of the sky [-], any length > 0
  double sun_radius = 0.06;               ///< angle between the sun's middle and its rim [rad]
  double sun_strength = 0.62;             ///< on a surface that faces it [-]
  double sky_strength = 0.55;             ///< on a surface that sees all of it [-]
};

/// Lights that turn with the camera: the sun stands behind the viewer's left shoulder, the sky
/// above and behind. For views from below, or wherever lights fixed in the world would shine at
/// the lens.
Lights over_the_shoulder(const Camera& camera);

/// Numbers of sub-frames: pictures that are averaged into one, each with another sun, other lights
/// of the sky, and pixels moved by a fraction. They smooth edges and shadows, and cost time.
/// @{
inline constexpr int kPreviewSubframes = 1;
inline constexpr int kVideoSubframes = 6;
inline constexpr int kPrintSubframes = 24;
/// @}

/// A scene and how it is seen.
struct Scene3 {
  std::vector<Ball> balls = {};               ///< grains
  std::vector<Tube> tubes = {};               ///< forces, rods
  std::vector<Line3> lines = {};              ///< edges
  std::vector<Pane> panes = {};               ///< walls
  std::vector<Cut> cuts = {};                 ///< what is taken out, at most 8
  std::optional<Floor> floor = {};            ///< catches shadows
  Camera camera = {};                         ///< where the picture is taken from
  Lights lights = {};                         ///< sun and sky
  Stroke outline = {{20, 20, 24, 150}, 0.3};  ///< where something nearer ends [pt]
  Colour background = style::kPaper;          ///< alpha 0 gives a transparent picture
  int subframes = kPrintSubframes;            ///< more are smoother and slower
};

/// Adds the twelve edges of a box.
void add_edges(Scene3& scene, const Box3& box, const Stroke& stroke = style::kEdgeLine);

/// Where the points of a scene lie on the page: for labels, scale bars and captions over a Picture.
class View3 {
 public:
  /// @param page rectangle that the picture fills [pt]; of the picture's proportions
  /// @throws ContractError as page_axes(), or if the page or the camera's height is not positive
  View3(const Camera& camera, const Box& page);

  /// @pre perspective: the point lies in front of the eye
  Vec<2> point(const Vec<3>& world) const;  ///< [m] -> [pt]
  double depth(const Vec<3>& world) const;  ///< before the eye, along the line of sight [m]
  double scale(const Vec<3>& world) const;  ///< of lengths across the line of sight [pt/m]

 private:
  Eigen::Matrix3d axes_;
  Vec<3> eye_;
  Vec<2> middle_;
  double scale_;     // at the target
  double distance_;  // of the target; 0 for parallel lines of sight
};

}  // namespace lagrain
