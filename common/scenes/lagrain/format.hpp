// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How frames and series are spelled in the folder of a run. A new format of frames is a class that
/// fulfils FrameFormat, a word in `OutputFormat` (scene.hpp), and a line in `make_formats`.

#include <lagrain/files.hpp>
#include <lagrain/frame.hpp>
#include <lagrain/state.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lagrain {

/// What writes the frames of one run. All that was written is in the files when a call returns.
template <int Dim>
class FrameFormat {
 public:
  virtual ~FrameFormat() = default;
  /// Called once, before anything else: removes what an earlier run left of this format.
  /// @throws SceneError here and below if a file cannot be written
  virtual void begin(const Run<Dim>& run) = 0;
  /// Keeps how far it has written; or goes on from there, instead of `begin`, and removes what was
  /// written later.
  /// @param frames  that there are so far
  virtual void persist(const Run<Dim>& run, StateVisitor visit, std::int64_t frames) = 0;
  /// Writes frame `number`; the run stands where the frame was taken.
  virtual void add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) = 0;
  /// About how long a frame with so many contacts is [bytes], to a factor of 2.
  virtual double bytes_per_frame(const Run<Dim>& run, double contacts) const = 0;
};

/// The formats that a scene asks for, for a folder that exists.
template <int Dim>
std::vector<std::unique_ptr<FrameFormat<Dim>>> make_formats(const OutputPlan& plan,
                                                            const std::filesystem::path& folder);

/// The tables that grow row by row: series.csv, and frames.csv, which lists the frames.
template <int Dim>
class RunTables {
 public:
  /// @param folder  exists; nothing is opened yet
  explicit RunTables(const std::filesystem::path& folder)
      : series_file_(folder / "series.csv"), frames_file_(folder / "frames.csv") {}

  /// Begins both with their first line.
  /// @throws SceneError here and below if a file cannot be written
  void begin(const Run<Dim>& run);
  /// See FrameFormat::persist.
  void persist(StateVisitor visit);
  /// Waits until everything lies on the disk.
  void sync_to_disk() const;
  void add_sample(const Sample& sample);                         ///< a row of the series
  void add_frame(const Frame<Dim>& frame, std::int64_t number);  ///< a row of the frames

 private:
  std::filesystem::path series_file_, frames_file_;
  std::optional<GrowingFile> series_, frames_;
};

/// The grains as CSV: id, place, velocity, spin if any, radius, material.
template <int Dim>
std::string frame_csv(const Run<Dim>& run, const Frame<Dim>& frame);
/// The same as they are now.
template <int Dim>
std::string frame_csv(const Run<Dim>& run) {
  return frame_csv(run, Frame<Dim>::of(run));
}

/// The contacts as CSV: the grain, its partner, overlap, normal, force on the first. The partner is
/// another grain (wall = -1), or a wall (j = -1), given by its place among the scene's walls.
template <int Dim>
std::string contacts_csv(const Run<Dim>& run);

/// The name of a frame's file: "grains_", 7, ".vtp" -> "grains_0007.vtp".
std::string numbered(std::string_view stem, std::int64_t number, std::string_view ending);

/// Removes the files of frames from a number on; whatever else lies in the folder stays.
void remove_numbered(const std::filesystem::path& folder, std::string_view stem,
                     std::string_view ending, std::int64_t first);

}  // namespace lagrain
