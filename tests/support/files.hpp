// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Files that tests write and read.

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace lagrain::test {

/// All of a file; empty if it cannot be read.
inline std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A place for one test's folder, which the test makes; gone afterwards.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() /
      ("lagrain_test_" + std::to_string(::getpid()) + "_" + std::to_string(++count));
  Folder() { std::filesystem::remove_all(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

 private:
  static inline int count = 0;
};

}  // namespace lagrain::test
