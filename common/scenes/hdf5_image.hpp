// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the sources of this folder: tables and texts as the bytes of an HDF5 file.

#include <lagrain/state.hpp>

#include <cstddef>
#include <string>
#include <string_view>

namespace lagrain::detail {

/// A state as an HDF5 file. A table of one column has one dimension, another one has two.
/// @param room  zeros in front of the file [bytes], for a header
std::string to_hdf5(const State& state, std::size_t room = 0);

/// The state that an HDF5 file holds. What the file does not hold is not made room for.
/// @throws SceneError if it is none, or holds something else
State from_hdf5(std::string_view image);

}  // namespace lagrain::detail
