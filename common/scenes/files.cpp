// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/files.hpp>

#include <lagrain/check.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

namespace lagrain {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void cannot_write(const fs::path& file, const std::string& reason) {
  throw SceneError(file.string() + ": cannot be written: " + reason);
}

/// What the last failed call on a stream says.
std::string last_reason() { return errno != 0 ? std::strerror(errno) : "unknown error"; }

}  // namespace

std::string why_unreadable(const fs::path& file) {
  std::error_code failure;
  if (fs::is_directory(file, failure)) return "is a folder, no file";
  errno = 0;
  if (std::ifstream(file, std::ios::binary)) return {};
  return errno == ENOENT ? "does not exist" : "cannot be read: " + last_reason();
}

std::string read_file(const fs::path& file) {
  const std::string why = why_unreadable(file);
  if (!why.empty()) throw SceneError(file.string() + ": " + why);
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return std::move(text).str();
}

void write_file(const fs::path& file, std::string_view text) {
  const fs::path part = file.string() + ".part";
  errno = 0;
  std::ofstream out(part, std::ios::binary);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  std::error_code failure;
  if (!out) {
    const std::string reason = last_reason();
    fs::remove(part, failure);
    cannot_write(file, reason);
  }
  fs::rename(part, file, failure);
  if (failure) {
    std::error_code ignored;
    fs::remove(part, ignored);
    cannot_write(file, failure.message());
  }
}

void make_folder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) cannot_write(folder, failure.message());
  if (!fs::is_directory(folder, failure)) cannot_write(folder, "it is no folder");
  const fs::path probe = folder / ".lagrain";
  write_file(probe, "");
  fs::remove(probe, failure);
}

void sync_to_disk(const fs::path& file) {
  errno = 0;
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && ::fsync(descriptor) == 0;
  const std::string reason = last_reason();
  if (descriptor >= 0) ::close(descriptor);
  if (!synced) cannot_write(file, reason);
}

GrowingFile::GrowingFile(fs::path file, std::uintmax_t length)
    : file_(std::move(file)), length_(length) {
  if (length > 0) {
    std::error_code failure;
    const std::uintmax_t size = fs::file_size(file_, failure);
    if (failure) cannot_write(file_, failure.message());
    if (size < length) {
      cannot_write(file_, "it has lost some of its rows: " + std::to_string(size) + " of " +
                              std::to_string(length) + " bytes are there");
    }
    fs::resize_file(file_, length, failure);
    if (failure) cannot_write(file_, failure.message());
  }
  errno = 0;
  out_.open(file_, std::ios::binary | (length > 0 ? std::ios::app : std::ios::trunc));
  if (!out_) cannot_write(file_, last_reason());
}

void GrowingFile::add(std::string_view text) {
  errno = 0;
  out_.write(text.data(), static_cast<std::streamsize>(text.size()));
  out_.flush();
  if (!out_) cannot_write(file_, last_reason());
  length_ += text.size();
}

}  // namespace lagrain
