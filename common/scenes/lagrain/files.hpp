// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Reading a file; files that are there whole or not at all, and files that grow.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace lagrain {

/// Why a file cannot be read, as the end of a sentence: "does not exist"; empty if it can.
std::string why_unreadable(const std::filesystem::path& file);

/// All of a file.
/// @throws SceneError if it is a folder or cannot be read
std::string read_file(const std::filesystem::path& file);

/// Writes a file whole or not at all, through a neighbour that is renamed.
/// @throws SceneError if that is not possible
void write_file(const std::filesystem::path& file, std::string_view text);

/// Makes a folder, with its parents, and sees that files can be written into it.
/// @throws SceneError if not
void make_folder(const std::filesystem::path& folder);

/// Waits until a file, or the entries of a folder, lie on the disk: a computer that fails from now
/// on keeps them.
/// @throws SceneError if that is not possible
void sync_to_disk(const std::filesystem::path& file);

/// A file that rows are added to. What has been added stays, however the program ends.
class GrowingFile {
 public:
  /// Begins an empty file, or goes on with one that exists.
  /// @param length  what is kept of it [bytes]; what follows is cut off
  /// @throws SceneError if that is not possible
  explicit GrowingFile(std::filesystem::path file, std::uintmax_t length = 0);
  /// @throws SceneError if the text cannot be written
  void add(std::string_view text);
  std::uintmax_t length() const { return length_; }  ///< [bytes]
  /// See lagrain::sync_to_disk.
  void sync_to_disk() const { lagrain::sync_to_disk(file_); }

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  std::uintmax_t length_;
};

}  // namespace lagrain
