// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the sources of this folder: the formats that frames are written in.

#include <lagrain/format.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
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

/// PolyData of VTK in vtp/: grains_NNNN.vtp, contacts_NNNN.vtp if contacts are asked for, and
/// walls_NNNN.vtp, the latter only once if no wall moves or goes. A file .pvd of each kind lists
/// them with their times.
template <int Dim>
class VtpFrames final : public FrameFormat<Dim> {
 public:
  explicit VtpFrames(const std::filesystem::path& folder) : folder_(folder / "vtp") {}

  void begin(const Run<Dim>& run) override;
  void persist(const Run<Dim>& run, StateVisitor visit, std::int64_t frames) override;
  void add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) override;
  double bytes_per_frame(const Run<Dim>& run, double contacts) const override;

 private:
  void clear(std::int64_t first) const;
  void list(std::string_view stem, std::size_t count) const;

  std::filesystem::path folder_;
  std::vector<double> times_;  // of the frames [s]
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
