// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The same display list by Cairo as pixels: an independent witness for the tests. Private
/// to render.

#include <lagrain/paint.hpp>

namespace lagrain::detail {

Image paint_rgba_cairo(const DisplayList& list, double dpi);

/// The bytes of a PDF file.
std::string encode_pdf(const DisplayList& list);

}  // namespace lagrain::detail
