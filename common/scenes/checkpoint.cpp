// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/checkpoint.hpp>

#include <lagrain/check.hpp>
#include <lagrain/files.hpp>

#include <boost/crc.hpp>

#include <hdf5.h>

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

namespace lagrain {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kKind = "lagrain checkpoint";
constexpr int kVersion = 1;
constexpr std::size_t kHeader = 512;  // HDF5 looks for its signature there next after 0

constexpr const char* kLast = "checkpoint.h5";
constexpr const char* kBefore = "checkpoint_before.h5";

std::uint32_t checksum(std::string_view bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

/// An object of HDF5 that is closed in the end.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id_ < 0) throw SceneError("HDF5 cannot make sense of it");
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { close_(id_); }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void expect(bool good) {
  if (!good) throw SceneError("HDF5 cannot make sense of it");
}

/// HDF5 prints what fails on the standard error stream; we say it in a sentence.
void be_silent() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

template <class Number>
hid_t memory_type();
template <>
hid_t memory_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t memory_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}

/// What lies on a disk is the same on every machine.
template <class Number>
hid_t file_type();
template <>
hid_t file_type<double>() {
  return H5T_IEEE_F64LE;
}
template <>
hid_t file_type<std::int64_t>() {
  return H5T_STD_I64LE;
}

Handle memory_file_access() {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  constexpr std::size_t kGrowth = std::size_t{1} << 20;
  H5Pset_fapl_core(access, kGrowth, false);
  return {access, H5Pclose};
}

template <class Number>
void put(hid_t file, const std::string& name, const NumberTable<Number>& table) {
  const std::array<hsize_t, 2> size{table.rows(), table.columns};
  const Handle space(H5Screate_simple(2, size.data(), nullptr), H5Sclose);
  const Handle set(H5Dcreate2(file, name.c_str(), file_type<Number>(), space, H5P_DEFAULT,
                              H5P_DEFAULT, H5P_DEFAULT),
                   H5Dclose);
  if (table.numbers.empty()) return;
  expect(H5Dwrite(set, memory_type<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                  table.numbers.data()) >= 0);
}

void put(hid_t file, const std::string& name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  expect(H5Tset_size(type, text.size() + 1) >= 0);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle set(
      H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  expect(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) >= 0);
}

template <class Number>
NumberTable<Number> numbers_in(hid_t set) {
  const Handle space(H5Dget_space(set), H5Sclose);
  std::array<hsize_t, 2> size{};
  expect(H5Sget_simple_extent_ndims(space) == 2 &&
         H5Sget_simple_extent_dims(space, size.data(), nullptr) == 2 && size[1] > 0);
  // What the file does not hold is not made room for.
  expect(size[0] <= H5Dget_storage_size(set) / sizeof(Number) / size[1]);
  NumberTable<Number> table{size[1], std::vector<Number>(size[0] * size[1])};
  if (!table.numbers.empty()) {
    expect(H5Dread(set, memory_type<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                   table.numbers.data()) >= 0);
  }
  return table;
}

std::string text_in(hid_t set, hid_t type) {
  expect(H5Tget_size(type) <= H5Dget_storage_size(set));
  std::string text(H5Tget_size(type), '\0');
  expect(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) >= 0);
  text.resize(text.find('\0'));
  return text;
}

/// Reads one object of a file, for H5Ovisit. Groups hold nothing but names.
herr_t take(hid_t file, const char* name, const H5O_info_t* info, void* to) {
  if (info->type != H5O_TYPE_DATASET) return 0;
  try {
    const Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
    const Handle type(H5Dget_type(set), H5Tclose);
    State& state = *static_cast<State*>(to);
    switch (H5Tget_class(type)) {
      case H5T_FLOAT:
        state.set(name, numbers_in<double>(set));
        return 0;
      case H5T_INTEGER:
        state.set(name, numbers_in<std::int64_t>(set));
        return 0;
      case H5T_STRING:
        state.set(name, text_in(set, type));
        return 0;
      default:
        return -1;
    }
  } catch (const SceneError&) {
    return -1;
  }
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
  be_silent();
  const Handle access = memory_file_access();
  const Handle file(H5Fcreate("checkpoint", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose);
  for (const auto& [name, value] : state.values()) {
    for (std::size_t slash = name.find('/'); slash != std::string::npos;
         slash = name.find('/', slash + 1)) {
      const std::string group = name.substr(0, slash);
      if (H5Lexists(file, group.c_str(), H5P_DEFAULT) > 0) continue;
      const Handle made(H5Gcreate2(file, group.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                        H5Gclose);
    }
    std::visit([&, &key = name](const auto& v) { put(file, key, v); }, value);
  }
  expect(H5Fflush(file, H5F_SCOPE_LOCAL) >= 0);
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  expect(size > 0);
  std::string bytes(kHeader + static_cast<std::size_t>(size), '\0');
  expect(H5Fget_file_image(file, bytes.data() + kHeader, static_cast<std::size_t>(size)) == size);
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

  be_silent();
  const Handle access = memory_file_access();
  expect(H5Pset_file_image(access, const_cast<char*>(image.data()), image.size()) >= 0);
  const Handle file(H5Fopen("checkpoint", H5F_ACC_RDONLY, access), H5Fclose);
  State state;
#if H5_VERSION_GE(1, 12, 0)
  expect(H5Ovisit3(file, H5_INDEX_NAME, H5_ITER_NATIVE, take, &state, H5O_INFO_BASIC) >= 0);
#else
  expect(H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, take, &state, H5O_INFO_BASIC) >= 0);
#endif
  return state;
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
