// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Files, whole or not at all. Private to render.

#include <lagrain/paint.hpp>

#include <filesystem>
#include <string>
#include <string_view>

namespace lagrain::detail {

/// A name in the same folder under which a file grows until it is complete; keeps the ending.
std::filesystem::path unfinished(const std::filesystem::path& path);

/// Writes bytes under a temporary name and renames.
/// @throws SceneError that names the file; nothing is left behind
void write_whole(const std::filesystem::path& path, std::string_view bytes);

/// The bytes of a PNG file.
std::string encode_png(const Image& image, double dpi);

}  // namespace lagrain::detail
