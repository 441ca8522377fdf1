// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Videos from painted frames: through ffmpeg when it is installed, as numbered PNG
/// files otherwise.

#include <lagrain/paint.hpp>

#include <filesystem>
#include <memory>

namespace lagrain {

/// What a VideoWriter has written.
struct VideoReport {
  bool encoded = false;        ///< true: one video file; false: a folder of numbered PNG files
  std::filesystem::path path;  ///< the file, or the folder
  int frames = 0;              ///< how many it has
};

/// Writes a video frame by frame. `.mp4` is H.264 with yuv420p, which plays everywhere; `.webm` is
/// VP9. Odd sizes lose a row or a column, because yuv420p wants even ones. Without ffmpeg on PATH
/// the frames go to the folder `<name>_frames` beside, as 000000.png and so on.
///
/// The video appears under its name only when finish() has succeeded; a writer that is destroyed
/// before leaves no video behind (frames already written as PNG stay).
class VideoWriter {
 public:
  /// @param path ends in .mp4 or .webm
  /// @pre fps >= 1
  /// @throws SceneError for another ending, or if nothing can be written there
  VideoWriter(const std::filesystem::path& path, int fps);
  ~VideoWriter();
  /// A writer can be moved; the one moved from is good for nothing but its end.
  /// @{
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;
  /// @}

  /// Adds a frame; its colours are laid over white where it is transparent.
  /// @pre all frames of a video have the size of the first, at least 2 x 2 pixels
  /// @throws SceneError if the encoder stops; the message repeats its complaint
  void add(const Image& frame);

  /// Completes the video. @throws SceneError as add(); ContractError if there are no frames
  VideoReport finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lagrain
