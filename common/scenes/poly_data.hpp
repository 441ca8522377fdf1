// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the sources of this folder: PolyData of VTK in XML, for ParaView and OVITO. A file
/// has a head that says which arrays there are, and the arrays behind it, raw and compressed by
/// zlib in blocks ("VTK XML Formats" of the VTK documentation).

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lagrain::detail {

/// Points with numbers, and the cells between them.
class PolyData {
 public:
  /// @param time  [s]
  PolyData(double time, std::size_t points) : time_(time), points_(points) {}

  /// A number, or a vector, for each point; Number is double, std::int32_t or std::int64_t.
  template <class Number>
  void at_points(std::string_view name, int components, const std::vector<Number>& values) {
    at_points_ += numbers(name, components, values);
  }
  /// The same for each cell.
  template <class Number>
  void at_cells(std::string_view name, int components, const std::vector<Number>& values) {
    at_cells_ += numbers(name, components, values);
  }
  /// @param places  three numbers for each point [m]
  void places(const std::vector<double>& places) { places_ = numbers("Points", 3, places); }
  /// @param kind    "Verts", "Lines" or "Polys"
  /// @param points  of all cells, one after another
  /// @param ends    for each cell, where its points end in that list
  void cells(std::string_view kind, const std::vector<std::int64_t>& points,
             const std::vector<std::int64_t>& ends);

  /// The bytes of the file.
  std::string file() const;

 private:
  /// Puts numbers behind the others. @return the element that says what they are
  template <class Number>
  std::string numbers(std::string_view name, int components, const std::vector<Number>& values);

  double time_;
  std::size_t points_;
  std::string at_points_, at_cells_, places_;
  std::string cell_kind_, cells_;
  std::size_t cell_count_ = 0;
  std::string data_;
};

/// begin, begin + step, begin + 2 step, ...
std::vector<std::int64_t> counted(std::size_t count, std::int64_t begin, std::int64_t step);

/// Adds a vector of the plane or of space as three numbers.
template <class V>
void add_vector(std::vector<double>& to, const V& v) {
  for (Eigen::Index d = 0; d < 3; ++d) to.push_back(d < v.size() ? v[d] : 0);
}

}  // namespace lagrain::detail
