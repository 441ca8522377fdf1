// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The commands draw, movie and plot: pictures of one's own runs.

#include <functional>
#include <memory>

namespace CLI {  // NOLINT: theirs
class App;
}

namespace lagrain::figures {

/// Adds the commands to the program, and does what they ask for.
class PictureCommands {
 public:
  explicit PictureCommands(CLI::App& program);
  ~PictureCommands();
  PictureCommands(const PictureCommands&) = delete;
  PictureCommands& operator=(const PictureCommands&) = delete;

  /// Whether one of them was given.
  bool parsed() const;
  /// @param stop  true once the user wants to stop
  /// @return 0
  /// @throws SceneError: one sentence; Interrupted
  int run(const std::function<bool()>& stop) const;

 private:
  struct Commands;
  std::unique_ptr<Commands> commands_;
};

}  // namespace lagrain::figures
