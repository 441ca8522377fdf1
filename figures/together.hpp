// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Several runs at once, each on a core of its own.

#include "figure.hpp"

#include <cstddef>
#include <functional>
#include <string>

namespace lagrain::figures {

/// Notes how far a piece of work has come [0 to 1]; false once it must stop.
using Watch = std::function<bool(double fraction)>;

/// Does pieces of work in their order, as many at once as there are cores, and shows how far all of
/// them have come. Stops them once the user wants to, or one of them fails.
/// @param piece  (number of the piece, its watch); asks the watch many times a second
/// @throws Interrupted; what the first one that failed has thrown
void do_together(std::size_t count,
                 const std::function<void(std::size_t k, const Watch& watch)>& piece,
                 const FigureOptions& options, const std::string& doing);

}  // namespace lagrain::figures
