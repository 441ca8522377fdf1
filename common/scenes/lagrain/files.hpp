// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Reading a file; files that are there whole or not at all, and files that grow.

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace lagrain {

/// All of a file.
/// @throws SceneError if it is a folder or cannot be read
std::string read_file(const std::filesystem::path& file);

/// Writes a file whole or not at all, through a neighbour that is renamed.
/// @throws SceneError if that is not possible
void write_file(const std::filesystem::path& file, std::string_view text);

/// Makes a folder, with its parents, and sees that files can be written into it.
/// @throws SceneError if not
void make_folder(const std::filesystem::path& folder);

/// A file that rows are added to. What has been added stays, however the program ends.
class GrowingFile {
 public:
  /// Begins an empty file.
  /// @throws SceneError if that is not possible
  explicit GrowingFile(std::filesystem::path file);
  /// @throws SceneError if the text cannot be written
  void add(std::string_view text);

 private:
  std::filesystem::path file_;
  std::ofstream out_;
};

}  // namespace lagrain
