// SPDX-License-Identifier: GPL-3.0-or-later
#include "hdf5_image.hpp"

#include <lagrain/check.hpp>

#include <hdf5.h>

#include <array>
#include <cstdint>
#include <variant>

namespace lagrain::detail {
namespace {

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

/// How an object is made: without the time of day, so that the same numbers are the same bytes.
Handle timeless(hid_t kind) {
  const hid_t properties = H5Pcreate(kind);
  H5Pset_obj_track_times(properties, false);
  return {properties, H5Pclose};
}

template <class Number>
void put(hid_t file, const std::string& name, const NumberTable<Number>& table) {
  const std::array<hsize_t, 2> size{table.rows(), table.columns};
  const Handle space(H5Screate_simple(table.columns == 1 ? 1 : 2, size.data(), nullptr), H5Sclose);
  const Handle properties = timeless(H5P_DATASET_CREATE);
  const Handle set(H5Dcreate2(file, name.c_str(), file_type<Number>(), space, H5P_DEFAULT,
                              properties, H5P_DEFAULT),
                   H5Dclose);
  if (table.numbers.empty()) return;
  expect(H5Dwrite(set, memory_type<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                  table.numbers.data()) >= 0);
}

void put(hid_t file, const std::string& name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  expect(H5Tset_size(type, text.size() + 1) >= 0);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle properties = timeless(H5P_DATASET_CREATE);
  const Handle set(
      H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
  expect(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) >= 0);
}

template <class Number>
NumberTable<Number> numbers_in(hid_t set) {
  const Handle space(H5Dget_space(set), H5Sclose);
  std::array<hsize_t, 2> size{0, 1};
  const int rank = H5Sget_simple_extent_ndims(space);
  expect((rank == 1 || rank == 2) &&
         H5Sget_simple_extent_dims(space, size.data(), nullptr) == rank && size[1] > 0);
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

}  // namespace

std::string to_hdf5(const State& state, std::size_t room) {
  be_silent();
  const Handle access = memory_file_access();
  const Handle file(H5Fcreate("image", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose);
  for (const auto& [name, value] : state.values()) {
    for (std::size_t slash = name.find('/'); slash != std::string::npos;
         slash = name.find('/', slash + 1)) {
      const std::string group = name.substr(0, slash);
      if (H5Lexists(file, group.c_str(), H5P_DEFAULT) > 0) continue;
      const Handle properties = timeless(H5P_GROUP_CREATE);
      const Handle made(H5Gcreate2(file, group.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT),
                        H5Gclose);
    }
    std::visit([&, &key = name](const auto& v) { put(file, key, v); }, value);
  }
  expect(H5Fflush(file, H5F_SCOPE_LOCAL) >= 0);
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  expect(size > 0);
  std::string bytes(room + static_cast<std::size_t>(size), '\0');
  expect(H5Fget_file_image(file, bytes.data() + room, static_cast<std::size_t>(size)) == size);
  return bytes;
}

State from_hdf5(std::string_view image) {
  be_silent();
  const Handle access = memory_file_access();
  expect(H5Pset_file_image(access, const_cast<char*>(image.data()), image.size()) >= 0);
  const Handle file(H5Fopen("image", H5F_ACC_RDONLY, access), H5Fclose);
  State state;
#if H5_VERSION_GE(1, 12, 0)
  expect(H5Ovisit3(file, H5_INDEX_NAME, H5_ITER_NATIVE, take, &state, H5O_INFO_BASIC) >= 0);
#else
  expect(H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, take, &state, H5O_INFO_BASIC) >= 0);
#endif
  return state;
}

}  // namespace lagrain::detail
