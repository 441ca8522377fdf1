// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `record` writes the folder of a run.
///
///     scene.toml       the scene with every default filled in; reads back to the same run
///     grains_N.csv     copies of the files of grains that it reads, if it reads any
///     start.h5         a copy of the state that it starts from, if it starts from another run's
///     series.csv       energies, contacts, overlaps, who came and left, wall forces against time
///     frames.csv       number, step and time of each frame
///     frames/NNNN.csv  the grains; contacts/NNNN.csv beside it if the scene asks for contacts
///     vtp/, frames.xyz, hdf5/
///                      the same for ParaView, OVITO and Python, if the scene asks for it
///     summary.txt      what the run was and how far it can be trusted
///     checkpoint.h5    the state at the end, or as it was not long before a sudden one; and
///                      checkpoint_before.h5, the one before (checkpoint.hpp)
///     last.csv         only after an error: the last good state
///
/// The first line of a CSV file is name[unit]. Numbers read back bit for bit. series.csv and
/// frames.csv grow row by row, and what has been written stays, however the program ends; every
/// other file is written whole or not at all.

#include <lagrain/checkpoint.hpp>
#include <lagrain/files.hpp>
#include <lagrain/format.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/run.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace lagrain {

/// "0.1.0"
const char* version();

/// Where a run is, for a progress line.
struct Progress {
  double fraction = 0;        ///< of the steps [-]
  double time = 0;            ///< simulated [s]
  std::int64_t contacts = 0;  ///< between grains, now
  double seconds_left = 0;    ///< of wall clock, guessed [s]
};

/// How a run is recorded.
struct RecordOptions {
  std::filesystem::path folder;                   ///< made if it is not there
  std::function<bool()> stop;                     ///< asked after every step
  std::function<void(const Progress&)> progress;  ///< told a few times a second
  /// Wall-clock time from one checkpoint to the next, unless to write one takes longer than a
  /// fiftieth of it [s].
  double checkpoint_every = 60;
};

/// Runs to the scene's duration and writes the folder. Frames of an earlier run are removed from
/// it, nothing else.
/// @return false if `stop` ended it; what was computed until then is written
/// @throws SceneError if the folder cannot be written: before the first step if possible
/// @throws SimulationError as Run::step, after writing what was computed, and the last good state
/// as last.csv and as a checkpoint; the run has gone back to it
template <int Dim>
bool record(Run<Dim>& run, const RecordOptions& options);

/// What recording a run will write.
struct OutputEstimate {
  double frames = 0;           ///< how many [-]
  double bytes_per_frame = 0;  ///< in all formats
  double bytes = 0;            ///< with series and checkpoints
};

/// Guesses, to a factor of 2, from the grains that are there now, as if they touched as in a bed.
template <int Dim>
OutputEstimate estimate_output(const Run<Dim>& run);

/// The dimension of the run that a checkpoint is of.
/// @throws SceneError if it holds no run
int checkpoint_dimension(const Checkpoint& checkpoint);

/// Makes a run again, as it was at its checkpoint.
/// @param until    the new end [s]; none: the scene's own
/// @param threads  as for make_run
/// @param watch    as for make_run: grains are placed before they take their state
/// @throws SceneError if the checkpoint holds no such run, or the new end has passed
template <int Dim>
std::unique_ptr<Run<Dim>> resume_run(const Checkpoint& checkpoint, std::optional<double> until = {},
                                     int threads = 0, const PlacementWatch& watch = {});

/// Goes on recording in the folder of the checkpoint, with the run that was made from it. What had
/// been written there later is written anew, so that series and frames are those of a run that was
/// left alone, bit for bit. Columns near_pairs and refreshes tell of the search and may differ;
/// losses are summed in its order, and may differ in their last digits.
/// @return see record
template <int Dim>
bool record_on(Run<Dim>& run, const Checkpoint& checkpoint, RecordOptions options);

}  // namespace lagrain
