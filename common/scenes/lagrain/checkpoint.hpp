// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Checkpoints: the state of a run in a file, from which it goes on.
///
/// A checkpoint is an HDF5 file whose tables have the names of the state; a row is a grain, in the
/// order of the slots, or a contact. In front of it lies a block of 512 bytes (which HDF5 skips)
/// with one line of text: what it is, how long it is, and a checksum of what follows. So a file
/// that was cut off or that a byte of has flipped is found out before anything of it is believed.

#include <lagrain/state.hpp>

#include <filesystem>
#include <string>
#include <string_view>

namespace lagrain {

/// A state as the bytes of a checkpoint.
std::string encode_checkpoint(const State& state);

/// The state that the bytes of a checkpoint hold.
/// @throws SceneError: one sentence without the name of the file
State decode_checkpoint(std::string_view bytes);

/// Puts a checkpoint into the folder of a run: beside the last one, which becomes the one before.
/// Whenever the program ends, one of the two is there and whole.
/// @throws SceneError if it cannot be written; what was there before is still there then
void write_checkpoint(const std::filesystem::path& folder, const State& state);

/// Where the last checkpoint of a run lies.
std::filesystem::path checkpoint_file(const std::filesystem::path& folder);

/// Removes the checkpoints from the folder of a run.
void remove_checkpoints(const std::filesystem::path& folder);

/// A checkpoint that was read.
struct Checkpoint {
  State state;                 ///< of the run
  std::filesystem::path file;  ///< where it was
  std::string trouble;         ///< why a newer one was left aside; empty if there was none
};

/// The last whole checkpoint in the folder of a run.
/// @throws SceneError if there is none
Checkpoint read_checkpoint(const std::filesystem::path& folder);

}  // namespace lagrain
