// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How frames and series are spelled in the folder of a run. A new format is a class beside
/// CsvFormat, and a line in the constructor of `Recorder` (record.cpp).

#include <lagrain/files.hpp>
#include <lagrain/frame.hpp>
#include <lagrain/state.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace lagrain {

/// What writes the frames and the series of one run. Everything written so far is in the files when
/// a call returns.
template <int Dim>
class RunFormat {
 public:
  virtual ~RunFormat() = default;
  /// Called once, before anything else: removes what an earlier run left of this format.
  /// @throws SceneError here and below if a file cannot be written
  virtual void begin(const Run<Dim>& run) = 0;
  /// Waits until everything lies on the disk.
  virtual void sync_to_disk() const = 0;
  /// Keeps how far it has written; or goes on from there, instead of `begin`, and removes what was
  /// written later.
  virtual void persist(const Run<Dim>& run, StateVisitor visit, std::int64_t frames) = 0;
  /// Adds a row to the series.
  virtual void add_sample(const Sample& sample) = 0;
  /// Writes frame `number`; the run stands where the frame was taken.
  virtual void add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) = 0;
  /// Writes the last good state of a run that went wrong.
  /// @return its file
  virtual std::filesystem::path write_last(const Run<Dim>& run, const Frame<Dim>& frame) = 0;
};

/// Comma-separated values: series.csv, frames.csv, frames/NNNN.csv, contacts/NNNN.csv, last.csv.
template <int Dim>
class CsvFormat final : public RunFormat<Dim> {
 public:
  /// Writes into a folder that exists.
  explicit CsvFormat(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void begin(const Run<Dim>& run) override;
  void sync_to_disk() const override;
  void persist(const Run<Dim>& run, StateVisitor visit, std::int64_t frames) override;
  void add_sample(const Sample& sample) override;
  void add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) override;
  std::filesystem::path write_last(const Run<Dim>& run, const Frame<Dim>& frame) override;

 private:
  void make_folders(const Run<Dim>& run) const;
  void remove_frames(std::int64_t first) const;

  std::filesystem::path folder_;
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

/// The contacts as CSV: the two partners, overlap, normal, force on the first. A wall is given by
/// its name.
template <int Dim>
std::string contacts_csv(const Run<Dim>& run);

}  // namespace lagrain
