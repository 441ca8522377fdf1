// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the sources of this folder: the formats that frames are written in.

#include <lagrain/format.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lagrain::detail {

/// Comma-separated values: frames/NNNN.csv, and contacts/NNNN.csv if contacts are asked for.
template <int Dim>
class CsvFrames final : public FrameFormat<Dim> {
 public:
  explicit CsvFrames(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void begin(const Run<Dim>& run) override;
  void persist(const Run<Dim>& run, StateVisitor visit, std::int64_t frames) override;
  void add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) override;
  double bytes_per_frame(const Run<Dim>& run, double contacts) const override;

 private:
  void clear(const Run<Dim>& run, std::int64_t first) const;

  std::filesystem::path folder_;
};

/// Files of VTK in vtp/, numbered, for each kind a list of them with their times (.pvd).
template <int Dim>
class VtkFrames : public FrameFormat<Dim> {
 public:
  void begin(const Run<Dim>& run) final;
  void persist(const Run<Dim>& run, StateVisitor visit, std::int64_t frames) final;
  void add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) final;

 protected:
  VtkFrames(const std::filesystem::path& folder, std::vector<std::string_view> kinds)
      : folder_(folder / "vtp"), kinds_(std::move(kinds)) {}
  /// Writes the files of a frame, and renews their lists.
  virtual void add_files(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) = 0;
  void write(std::string_view kind, std::int64_t number, const std::string& bytes) const;
  /// Lists the files of the first frames.
  void list(std::string_view kind, std::int64_t count) const;

 private:
  void clear(std::int64_t first) const;

  std::filesystem::path folder_;
  std::vector<std::string_view> kinds_;
  std::vector<double> times_;  // of the frames [s]
};

/// PolyData of VTK: grains_NNNN.vtp, contacts_NNNN.vtp if contacts are asked for, and
/// walls_NNNN.vtp, the latter only once if no wall moves or goes.
template <int Dim>
class VtpFrames final : public VtkFrames<Dim> {
 public:
  explicit VtpFrames(const std::filesystem::path& folder);
  double bytes_per_frame(const Run<Dim>& run, double contacts) const override;

 private:
  void add_files(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) override;
};

/// The grains' regular triangulation and Laguerre cells: edges_NNNN.vtp, cells_NNNN.vtp.
template <int Dim>
class CellFrames final : public VtkFrames<Dim> {
 public:
  explicit CellFrames(const std::filesystem::path& folder);
  double bytes_per_frame(const Run<Dim>& run, double contacts) const override;

 private:
  void add_files(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) override;
};

/// HDF5: hdf5/NNNN.h5, a table for each thing that grains have, and contacts if they are asked for.
template <int Dim>
class Hdf5Frames final : public FrameFormat<Dim> {
 public:
  explicit Hdf5Frames(const std::filesystem::path& folder) : folder_(folder / "hdf5") {}

  void begin(const Run<Dim>& run) override;
  void persist(const Run<Dim>& run, StateVisitor visit, std::int64_t frames) override;
  void add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) override;
  double bytes_per_frame(const Run<Dim>& run, double contacts) const override;

 private:
  void clear(std::int64_t first) const;

  std::filesystem::path folder_;
};

/// Extended XYZ: all frames one after another in frames.xyz.
template <int Dim>
class XyzFrames final : public FrameFormat<Dim> {
 public:
  explicit XyzFrames(const std::filesystem::path& folder) : name_(folder / "frames.xyz") {}

  void begin(const Run<Dim>& run) override;
  void persist(const Run<Dim>& run, StateVisitor visit, std::int64_t frames) override;
  void add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) override;
  double bytes_per_frame(const Run<Dim>& run, double contacts) const override;

 private:
  std::filesystem::path name_;
  std::optional<GrowingFile> file_;
};

/// About how long a number is in a text of all its digits [bytes].
inline constexpr double kTextBytes = 20;

}  // namespace lagrain::detail
