// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What diagrams share: processor time, straight lines through points, observed orders.

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace lagrain::bench {

/// Processor time of this thread [s]; a shared machine takes the wall clock's time away.
double processor_seconds();

/// The middle value; NaN without any.
double median_of(std::vector<double> values);

/// Processor time of one call [s]: the median of three rounds, each of as many calls as fill
/// `least` seconds.
double seconds_per_call(const std::function<void()>& call, double least = 0.02);

/// Slope of the straight line through (x, y), by least squares; NaN with fewer than two points.
double slope_of(std::span<const double> x, std::span<const double> y);

/// Slope of the straight line through (log x, log y), by least squares: the order at which an error
/// y falls with a step x. Points that are not positive are left out; NaN with fewer than two.
double observed_order(std::span<const double> x, std::span<const double> y);

}  // namespace lagrain::bench
