// SPDX-License-Identifier: GPL-3.0-or-later
#include "grain_file.hpp"

#include "scene_keys.hpp"
#include "toml_table.hpp"

#include <lagrain/csv_rows.hpp>
#include <lagrain/files.hpp>
#include <lagrain/words.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace lagrain::detail {
namespace {

namespace fs = std::filesystem;

/// Text from a file as a message shows it.
std::string shown_cell(std::string_view cell) { return cell.empty() ? "nothing" : shown(cell); }

/// A column that is read.
struct Column {
  std::string name;       // without its unit
  std::string unit;       // in brackets behind the name, or left out
  std::string what;       // its numbers are, with the article
  std::size_t place = 0;  // among the cells of a row
  bool is_there = false;

  std::string title() const { return name + "[" + unit + "]"; }
};

/// The columns x, y, z of a vector.
template <int N>
std::array<Column, N> vector_columns(const std::string& stem, const std::string& unit,
                                     const std::string& what) {
  std::array<Column, N> columns;
  for (std::size_t d = 0; d < N; ++d) columns[d] = {stem + "xyz"[d], unit, what};
  return columns;
}

template <int Dim>
class Reader {
 public:
  Reader(const Scene<Dim>& scene, std::size_t index)
      : scene_(scene),
        asked_(scene.grain_files[index]),
        key_(std::string(keys::kGrains.name) + "[" + std::to_string(index) + "]"),
        name_(shortened(asked_.file.string(), 200)),
        text_(read()),
        rows_(text_) {
    if constexpr (Dim == 2) {
      spin_[0] = {"omega", "rad/s", "an angular velocity"};
    } else {
      spin_ = vector_columns<3>("omega_", "rad/s", "an angular velocity");
    }
  }

  ListedGrains<Dim> grains() {
    if (!rows_.next()) throw SceneError(name_ + ": empty; expected " + columns_in_words());
    find_columns();
    ListedGrains<Dim> list;
    while (rows_.next()) {
      list.grains.push_back(grain());
      list.lines.push_back(rows_.line());
    }
    if (list.grains.empty()) fail("no grain below the names of the columns");
    return list;
  }

 private:
  std::string read() const {
    const auto refuse = [&](const std::string& why) {
      throw scene_.error(key_ + "." + std::string(keys::kFile.name), "\"" + name_ + "\" " + why);
    };
    const std::string why = why_unreadable(asked_.file);
    if (!why.empty()) refuse(why + "; a path is taken from the folder of the scene file");
    std::error_code failure;
    if (!fs::is_regular_file(asked_.file, failure)) {
      refuse("is no file; expected a file of grains (CSV)");
    }
    return read_file(asked_.file);
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw SceneError(name_ + ":" + std::to_string(rows_.line()) + ": " + message);
  }
  [[noreturn]] void expected(const Column& column, const std::string& what) const {
    fail(column.name + ": expected " + what + ", got " + shown_cell(rows_.cells()[column.place]));
  }

  /// Which columns there may be, for messages.
  static std::string columns_in_words() {
    return std::string("a first line with the names of columns, separated by commas: ") +
           (Dim == 2 ? "x[m], y[m]" : "x[m], y[m], z[m]") + " and radius[m], and if wanted " +
           (Dim == 2
                ? "vx[m/s], vy[m/s]; omega[rad/s]"
                : "vx[m/s], vy[m/s], vz[m/s]; omega_x[rad/s], omega_y[rad/s], omega_z[rad/s]") +
           "; material";
  }

  /// Whether the first line names the column, which then knows its place.
  bool find(Column& column) {
    for (std::size_t k = 0; k < rows_.cells().size(); ++k) {
      const auto [name, unit] = name_and_unit(rows_.cells()[k]);
      if (name != column.name) continue;
      if (column.is_there) fail("a second column \"" + column.name + "\"");
      if (!unit.empty() && unit != column.unit) {
        fail("column " + shown_cell(rows_.cells()[k]) + ": expected " + column.title());
      }
      column.place = k;
      column.is_there = true;
    }
    return column.is_there;
  }
  void require(Column& column) {
    if (find(column)) return;
    std::vector<std::string> others;
    for (const std::string_view title : rows_.cells()) {
      const std::string name(name_and_unit(title).first.substr(0, 40));
      bool taken = name == "id" || name == radius_.name;
      for (const Column& c : position_) taken = taken || c.name == name;
      if (!taken) others.push_back(name);
    }
    fail("no column \"" + column.title() + "\"" + suggestion(column.name, others) + "; expected " +
         columns_in_words());
  }
  /// All columns of a vector, or none.
  template <std::size_t N>
  bool find_all(std::array<Column, N>& columns) {
    bool any = false;
    for (Column& column : columns) any = find(column) || any;
    if (!any) return false;
    for (Column& column : columns) {
      if (!column.is_there) require(column);
    }
    return true;
  }

  void find_columns() {
    for (Column& column : position_) require(column);
    require(radius_);
    if (Column z{"z", "m", ""}; Dim == 2 && find(z)) {
      fail("column \"z\": discs have none; remove it, or write dimension = 3");
    }
    moving_ = find_all(velocity_) && !asked_.at_rest && !asked_.pinned;
    spinning_ = find_all(spin_) && !asked_.at_rest && !asked_.pinned;
    columns_ = rows_.cells().size();
    if (asked_.material || find(material_) || scene_.materials.size() == 1) return;
    throw scene_.error(key_ + "." + std::string(keys::kMaterial.name),
                       "missing; expected a name, because the scene has several materials and \"" +
                           name_ + "\" has no column \"material\"");
  }

  PlacedGrain<Dim> grain() {
    if (rows_.cells().size() != columns_) {
      fail(std::to_string(rows_.cells().size()) + " values, expected " + std::to_string(columns_) +
           ", as many as columns are named");
    }
    PlacedGrain<Dim> grain;
    read(position_, grain.position);
    grain.position += asked_.shift;
    grain.radius = number(radius_);
    if (!(grain.radius > 0)) expected(radius_, "a positive length [m]");
    if (moving_) read(velocity_, grain.velocity);
    if (spinning_) read(spin_, grain.spin);
    grain.material = material();
    grain.pinned = asked_.pinned;
    grain.driven = asked_.driven;
    return grain;
  }

  template <std::size_t N, class V>
  void read(const std::array<Column, N>& columns, V& v) const {
    for (std::size_t d = 0; d < N; ++d) v[static_cast<Eigen::Index>(d)] = number(columns[d]);
  }
  double number(const Column& column) const {
    std::string_view cell = rows_.cells()[column.place];
    if (cell.starts_with('+')) cell.remove_prefix(1);
    double value = 0;
    const char* const end = cell.data() + cell.size();
    const auto [stop, failure] = std::from_chars(cell.data(), end, value);
    if (failure != std::errc{} || stop != end || !std::isfinite(value)) {
      expected(column, column.what + " [" + column.unit + "]");
    }
    return value;
  }

  int material() {
    if (asked_.material) return *asked_.material;
    if (!material_.is_there) return with_density(0);
    const std::string_view cell = rows_.cells()[material_.place];
    // Neighbours in a file are mostly of one material.
    if (last_ && scene_.materials[static_cast<std::size_t>(*last_)].name == cell) return *last_;
    std::vector<std::string> names;
    for (std::size_t m = 0; m < scene_.materials.size(); ++m) {
      if (scene_.materials[m].name == cell) return *(last_ = with_density(static_cast<int>(m)));
      names.push_back(scene_.materials[m].name);
    }
    fail("material: no material " + shown_cell(cell) + suggestion(cell.substr(0, 40), names) +
         "; expected one of the scene's [materials.NAME], or in " + key_ +
         " material = \"...\" for all grains of the file");
  }
  int with_density(int material) const {
    const Material& m = scene_.materials[static_cast<std::size_t>(material)];
    if (m.density > 0) return material;
    fail("material: grains of \"" + m.name + "\" need [materials." + m.name + "] density");
  }

  const Scene<Dim>& scene_;
  const GrainFile<Dim>& asked_;
  std::string key_;   // of the file in the scene
  std::string name_;  // of the file
  std::string text_;
  CsvRows rows_;
  std::array<Column, Dim> position_ = vector_columns<Dim>("", "m", "a length");
  std::array<Column, Dim> velocity_ = vector_columns<Dim>("v", "m/s", "a speed");
  std::array<Column, kSpinDim<Dim>> spin_;
  Column radius_{"radius", "m", "a positive length"};
  Column material_{"material", "-", "a name"};
  bool moving_ = false;
  bool spinning_ = false;
  std::size_t columns_ = 0;
  std::optional<int> last_;  // the material of the row before
};

}  // namespace

template <int Dim>
ListedGrains<Dim> read_grains(const Scene<Dim>& scene, std::size_t index) {
  return Reader<Dim>(scene, index).grains();
}

template ListedGrains<2> read_grains<2>(const Scene<2>&, std::size_t);
template ListedGrains<3> read_grains<3>(const Scene<3>&, std::size_t);

}  // namespace lagrain::detail
