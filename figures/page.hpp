// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Pieces of a page of the gallery.

#include <filesystem>
#include <string>

namespace lagrain {

/// Everything up to the body's first element.
std::string page_head(const std::string& title);

/// Text as it must stand in HTML.
std::string escaped(const std::string& text);

/// A path as a link inside the gallery: relative to it, with what a URL cannot hold encoded.
std::string page_link(const std::filesystem::path& file, const std::filesystem::path& out);

}  // namespace lagrain
