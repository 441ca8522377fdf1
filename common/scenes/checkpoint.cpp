// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/checkpoint.hpp>

#include "hdf5_image.hpp"

#include <lagrain/check.hpp>
#include <lagrain/files.hpp>

#include <boost/crc.hpp>

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <system_error>
#include <vector>

namespace lagrain {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kKind = "lagrain checkpoint";
constexpr int kVersion = 2;
constexpr std::size_t kHeader = 512;  // HDF5 looks for its signature there next after 0

constexpr const char* kLast = "checkpoint.h5";
constexpr const char* kBefore = "checkpoint_before.h5";

std::uint32_t checksum(std::string_view bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

std::string header(std::string_view image) {
  std::array<char, kHeader> text{};
  std::snprintf(text.data(), text.size(),
                "%s %d: HDF5 from byte %zu on, %zu bytes, CRC-32 (hexadecimal): %08x\n",
                kKind.data(), kVersion, kHeader, image.size(),
                static_cast<unsigned>(checksum(image)));
  return {text.data(), text.size()};
}

}  // namespace

std::string encode_checkpoint(const State& state) {
  std::string bytes = detail::to_hdf5(state, kHeader);
  bytes.replace(0, kHeader, header(std::string_view(bytes).substr(kHeader)));
  return bytes;
}

State decode_checkpoint(std::string_view bytes) {
  if (!bytes.starts_with(kKind)) throw SceneError("it is no checkpoint");
  if (bytes.size() < kHeader) throw SceneError("it was cut off in its first line");
  const std::string_view head = bytes.substr(0, kHeader), image = bytes.substr(kHeader);
  int version = 0;
  std::from_chars(head.data() + kKind.size() + 1, head.data() + head.size(), version);
  if (version != kVersion) {
    throw SceneError("it is of version " + std::to_string(version) +
                     ", and this program reads version " + std::to_string(kVersion) +
                     "; resume it with the lagrain that wrote it");
  }
  if (head != header(image)) {
    throw SceneError(
        "it was cut off or changed: length and checksum are not those of its first line");
  }
  return detail::from_hdf5(image);
}

void write_checkpoint(const fs::path& folder, const State& state) {
  const fs::path last = folder / kLast, fresh = folder / "checkpoint.h5.new";
  write_file(fresh, encode_checkpoint(state));
  sync_to_disk(fresh);
  std::error_code failure;
  if (fs::exists(last, failure)) fs::rename(last, folder / kBefore, failure);
  if (!failure) fs::rename(fresh, last, failure);
  if (failure) throw SceneError(last.string() + ": cannot be written: " + failure.message());
  sync_to_disk(folder);
}

fs::path checkpoint_file(const fs::path& folder) { return folder / kLast; }

void remove_checkpoints(const fs::path& folder) {
  std::error_code ignored;
  for (const char* name : {kLast, kBefore}) fs::remove(folder / name, ignored);
}

Checkpoint read_checkpoint(const fs::path& folder) {
  std::string trouble;
  for (const char* name : {kLast, kBefore}) {
    const fs::path file = folder / name;
    std::error_code failure;
    if (!fs::exists(file, failure)) continue;
    try {
      return {decode_checkpoint(read_file(file)), file, trouble};
    } catch (const SceneError& error) {
      trouble += (trouble.empty() ? "" : "; ") + file.string() + ": " + error.what();
    }
  }
  if (!trouble.empty()) throw SceneError(trouble);
  const std::string wanted = std::string("checkpoint (") + kLast + ")";
  std::error_code ignored;
  throw SceneError(folder.string() + (fs::is_directory(folder, ignored)
                                          ? ": there is no " + wanted + " in this folder"
                                          : ": there is no such folder, and so no " + wanted));
}

}  // namespace lagrain
