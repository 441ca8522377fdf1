// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The folder of a run as something to look at: states of its grains, its walls where they were
/// then, its contacts as far as they are known, and the columns of its series. The run may be
/// finished, going on, or broken off; nothing in the folder is changed.

#include <lagrain/checkpoint.hpp>
#include <lagrain/csv_rows.hpp>
#include <lagrain/frame.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lagrain::figures {

/// A state of a run that can be drawn.
template <int Dim>
struct Snapshot {
  std::string source;              ///< for people: "frame 12"
  Frame<Dim> frame;                ///< the grains
  std::vector<Wall<Dim>> walls;    ///< as they were then
  std::vector<std::string> group;  ///< N, names of the groups; empty if they are not known
  /// Grains by their columns in the frame; none if they are not known.
  std::optional<std::vector<ContactRecord<Dim>>> contacts;
};

/// What a run is now.
template <int Dim>
Snapshot<Dim> snapshot_of(const Run<Dim>& run);

/// A file of comma-separated values as a run writes it, without a last row that is not ended yet.
class CsvFile {
 public:
  /// @throws SceneError if it cannot be read or is empty
  explicit CsvFile(std::filesystem::path file);

  const std::vector<std::string>& names() const { return names_; }  ///< of columns, without units
  const std::vector<std::string>& units() const { return units_; }  ///< of the same
  std::optional<std::size_t> find(const std::string& name) const;   ///< place of a column
  std::size_t column(const std::string& name) const;  ///< the same; @throws SceneError without it
  /// Goes to the next row. @return whether there is one
  bool next();
  /// A cell of this row; one that is empty is NaN. @throws SceneError if it is no number
  double number(std::size_t column) const;
  /// The same of a whole number. @throws SceneError if it is none
  std::int64_t whole(std::size_t column) const;
  /// A cell of this row.
  std::string word(std::size_t column) const { return std::string(rows_.cells()[column]); }

 private:
  [[noreturn]] void fail(const std::string& message) const;

  std::filesystem::path file_;
  std::string text_;
  CsvRows rows_;
  std::vector<std::string> names_, units_;
};

/// The dimension of the run in a folder.
/// @throws SceneError if it is no folder of a run
int dimension_of_run(const std::filesystem::path& folder);

/// The states that are kept in the folder of a run.
template <int Dim>
class RunFolder {
 public:
  /// @throws SceneError if it is no folder of a run
  explicit RunFolder(std::filesystem::path folder);

  const std::filesystem::path& path() const { return folder_; }
  const Scene<Dim>& scene() const { return scene_; }  ///< that was run
  std::size_t frames() const { return frames_.size(); }
  double time_of(std::size_t frame) const { return frames_[frame].time; }  ///< [s]

  /// What a picture needs besides the grains.
  struct Wish {
    bool contacts = false;  ///< and their forces
    bool groups = false;    ///< names of the groups
  };
  /// The state of a frame.
  /// @throws SceneError if a file is damaged, or a wish cannot be fulfilled
  Snapshot<Dim> at(std::size_t frame, Wish wish) const;
  /// The state nearest to a time: a frame, the checkpoint, or the last good state of a run that
  /// broke off.
  /// @param time  [s]; none: the last
  Snapshot<Dim> nearest(std::optional<double> time, Wish wish) const;

 private:
  struct Listed {
    std::filesystem::path file;
    std::filesystem::path contacts;  // empty: not there
    std::string source;
    std::int64_t step = 0;
    double time = 0;  // [s]
  };
  Snapshot<Dim> read(const Listed& listed, Wish wish) const;
  Frame<Dim> read_grains(const Listed& listed) const;
  std::vector<ContactRecord<Dim>> read_contacts(const std::filesystem::path& file,
                                                const Snapshot<Dim>& snapshot) const;
  std::vector<Wall<Dim>> walls_at(double time) const;
  /// The run as its checkpoint has it, made once; null if there is no checkpoint.
  const Run<Dim>* checkpointed() const;

  std::filesystem::path folder_;
  Scene<Dim> scene_;
  std::vector<Listed> frames_;
  mutable std::optional<Checkpoint> checkpoint_;
  mutable std::unique_ptr<Run<Dim>> run_;
};

}  // namespace lagrain::figures
