// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Pictures of one's own scene: a state of a run as a page with its grains, forces, walls, a length
/// bar, the time, and a colour bar or a legend. Discs come as shapes, spheres as pixels beneath
/// labels that are shapes.

#include "run_folder.hpp"

#include <lagrain/display_list.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/plot.hpp>
#include <lagrain/scene3.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace lagrain::figures {

/// What colours the grains.
enum class ColourBy {
  plain,         ///< nothing: all alike
  speed,         ///< [m/s]
  force,         ///< sum of the magnitudes of the contact forces on a grain [N]
  material,      ///< what it is made of
  group,         ///< the fill or inlet that it came from
  spin,          ///< in the plane with its sign, counter-clockwise positive [rad/s]
  radius,        ///< [m]
  coordination,  ///< number of contacts, walls included
  height,        ///< along the last axis [m]
};

/// What is wanted on a picture.
struct PictureWish {
  bool grains = true;
  bool forces = false;
  bool cells = false;
  bool edges = false;
  bool skins = false;
  bool walls = true;
  std::optional<ColourBy> colour = {};  ///< none: materials if several, or the speed
  /// Azimuth and elevation of who looks at spheres [rad]. With azimuth 0 they look along y.
  Vec<2> view = Vec<2>(-0.56, 0.40);
  std::vector<Cut> cuts = {};                   ///< what is taken out of spheres
  std::optional<std::array<int, 2>> size = {};  ///< width and height [px]; none: as it fits
  int subframes = kPrintSubframes;              ///< of spheres

  bool needs_contacts() const {
    return forces || colour == ColourBy::force || colour == ColourBy::coordination;
  }
  bool needs_groups() const { return colour == ColourBy::group; }
};

/// What all pictures of a film have in common.
template <int Dim>
struct PictureScale {
  Eigen::AlignedBox<double, Dim> window;  ///< that is shown [m]
  ColourBy colour = ColourBy::plain;
  double low = 0, high = 1;        ///< of the colour bar
  bool cut_off = false;            ///< whether some values lie above it
  std::vector<std::string> names;  ///< of the categories
  double strongest = 0;            ///< force that is drawn thickest [N]
  double mean_radius = 0;          ///< [m]

  /// Width of the line of the strongest force [m]: chains stand out, and grains are seen between.
  double thickest() const {
    return std::min((Dim == 2 ? 2.2 : 0.9) * mean_radius, 0.025 * window.diagonal().norm());
  }
  /// Widens it so that it holds for another picture as well.
  void extend(const PictureScale& other);
};

/// The scale for one state.
/// @throws SceneError if there is nothing to see, or the colour does not apply
template <int Dim>
PictureScale<Dim> scale_of(const Scene<Dim>& scene, const Snapshot<Dim>& snapshot,
                           const PictureWish& wish);

/// The colour of each grain.
template <int Dim>
std::vector<Colour> grain_colours(const Snapshot<Dim>& snapshot, const PictureWish& wish,
                                  const PictureScale<Dim>& scale);

/// Spheres as they are lit and seen, without a camera yet.
Scene3 space_of(const Scene<3>& scene, const Snapshot<3>& snapshot, const PictureWish& wish,
                const PictureScale<3>& scale);

/// The direction from the viewer into the picture [-].
Vec<3> line_of_sight(const Vec<2>& view);

/// A page, and how finely it is to be painted so that it has the wanted size.
struct PicturePage {
  DisplayList list;
  double dpi = 300;
};

/// The picture of a state.
template <int Dim>
PicturePage picture_of(const Scene<Dim>& scene, const Snapshot<Dim>& snapshot,
                       const PictureWish& wish, const PictureScale<Dim>& scale);

/// Text as a label shows it: no markup, and no letter that the font lacks.
std::string label_text(const std::string& text);

/// Columns of a series against time, one panel below the other for each unit.
/// @param names  of columns; none: the energies
/// @throws SceneError for a name that is none, with the nearest one
PicturePage plot_of_series(const std::filesystem::path& series, std::vector<std::string> names,
                           std::optional<std::array<int, 2>> size = {});

/// Writes a page as its ending says: .png, .pdf or .svg.
/// @throws SceneError for another ending, or if it cannot be written
void write_page(const PicturePage& page, const std::filesystem::path& file);

}  // namespace lagrain::figures
