// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Colours, and maps from a number to a colour that stay readable in grey print.

#include <cstdint>

namespace lagrain {

/// sRGB, 8 bits per channel; alpha is straight (not premultiplied), 255 is opaque.
struct Colour {
  std::uint8_t r = 0;    ///< red
  std::uint8_t g = 0;    ///< green
  std::uint8_t b = 0;    ///< blue
  std::uint8_t a = 255;  ///< alpha

  friend bool operator==(const Colour&, const Colour&) = default;
};

/// The same colour with another opacity in [0, 1].
Colour with_alpha(Colour colour, double alpha);

/// Mixes two colours in sRGB values: `from` at t = 0, `to` at t = 1; t in [0, 1].
Colour mix(Colour from, Colour to, double t);

/// Perceived lightness L* of CIELAB, from 0 (black) to 100 (white), for an sRGB colour;
/// ignores alpha.
double lightness(Colour colour);

/// Colour maps of 256 entries.
enum class ColourMap {
  viridis,   ///< ordered quantities: dark blue to yellow, lightness increases throughout
  cividis,   ///< ordered quantities: the same with and without colour blindness
  blue_red,  ///< signed quantities: blue (negative), light grey (zero), red (positive)
};

/// Colour of `map` at t; t is clamped to [0, 1], and NaN gives a neutral grey.
Colour colour(ColourMap map, double t);

/// Categories: eight colours that people with colour blindness tell apart. The index wraps around.
///
/// Source: Okabe & Ito, Color Universal Design (2008), in an order that puts the darker ones first.
Colour category(int index);

}  // namespace lagrain
