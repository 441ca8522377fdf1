// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Painters: the same display list as pixels, as PDF or as SVG.
///
/// Files are written whole or not at all. The same list gives the same bytes, run after run.

#include <lagrain/display_list.hpp>
#include <lagrain/scene3.hpp>

#include <filesystem>

namespace lagrain {

/// How finely pixels are painted.
enum class Quality {
  still,  ///< for figures: four samples a pixel, each with analytic coverage
  frame,  ///< for video: one sample with analytic coverage, a third of the time
};

/// Paints the list into pixels; the page becomes round(width * dpi / 72) pixels wide, at least one.
/// Colours are mixed in sRGB values, as PDF viewers do. May be called from any thread; one call
/// paints at a time.
/// @param dpi pixels per inch
/// @throws SceneError    if the picture is too large for the renderer or OpenGL is missing
/// @throws ContractError if clips are not balanced, or a label's markup is wrong
Image paint_rgba(const DisplayList& list, double dpi, Quality quality = Quality::still);

/// Paints a three-dimensional scene into pixels. The same scene gives the same bytes on one
/// machine. May be called from any thread; one call paints at a time. Bodies and lines that reach
/// behind the eye of a perspective camera are left out.
/// @param width, height of the picture [px]
/// @param dpi pixels per inch, for widths given in points; at 72 a point is a pixel
/// @pre at most 8 cuts; scene.subframes >= 1
/// @throws SceneError    if the picture is too large for the renderer or OpenGL is missing
/// @throws ContractError if the camera sees nothing (no height, eye at the target), or a cut, a
///                       pane, the floor or a light has no direction
Image paint_scene3(const Scene3& scene, int width, int height, double dpi = 72);

/// Paints a scene for a place on a page: add the result to a display list, labels on top of it by
/// View3 with the same box.
/// @param box rectangle on the page that the picture fills [pt]
/// @throws as the function above
Picture paint_scene3(const Scene3& scene, const Box& box, double dpi = 300);

/// Paints the list into a PNG file that knows its resolution.
/// @throws SceneError that names the file if it cannot be written
void paint_png(const DisplayList& list, const std::filesystem::path& path, double dpi = 300);

/// Paints the list into a PDF file; text stays text, its fonts are embedded.
/// @throws SceneError that names the file if it cannot be written
void paint_pdf(const DisplayList& list, const std::filesystem::path& path);

/// Paints the list into an SVG file, for small figures; glyphs become outlines.
/// @throws SceneError that names the file if it cannot be written
void paint_svg(const DisplayList& list, const std::filesystem::path& path);

/// Writes pixels as a PNG file.
/// @param dpi pixels per inch, kept in the file; 0 for none
/// @throws SceneError that names the file if it cannot be written
void write_png(const Image& image, const std::filesystem::path& path, double dpi = 0);

}  // namespace lagrain
