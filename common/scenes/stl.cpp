// SPDX-License-Identifier: GPL-3.0-or-later
#include "stl.hpp"

#include <lagrain/files.hpp>

#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>

#include <array>
#include <cctype>
#include <cstddef>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace lagrain::detail {

namespace {

using Points = std::vector<CGAL::Simple_cartesian<double>::Point_3>;
using Facets = std::vector<std::array<std::size_t, 3>>;

/// Text may be in capitals, which CGAL does not know: then its words are made small.
bool read(const std::filesystem::path& file, Points& points, Facets& facets) {
  if (CGAL::IO::read_STL(file.string(), points, facets)) return true;
  points.clear();
  facets.clear();
  std::string text = read_file(file);
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  std::istringstream in(text);
  return CGAL::IO::read_STL(in, points, facets);
}

}  // namespace

std::vector<WallPiece<3>> read_stl(const std::filesystem::path& file, double scale) {
  const std::string why = why_unreadable(file);
  if (!why.empty()) throw std::invalid_argument(why);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) throw std::invalid_argument("is no file");
  Points points;
  Facets facets;
  if (!read(file, points, facets)) {
    throw std::invalid_argument("it is no STL file");
  }
  std::vector<WallPiece<3>> pieces;
  for (const auto& facet : facets) {
    std::vector<Vec<3>> corners;
    for (const std::size_t k : facet) {
      const auto& p = points[k];
      corners.push_back(scale * Vec<3>(p.x(), p.y(), p.z()));
      if (!corners.back().allFinite()) {
        throw std::invalid_argument("facet " + std::to_string(pieces.size() + 1) +
                                    " has a corner that is not finite");
      }
    }
    if (Plate::defect(corners).empty()) pieces.push_back(Plate(std::move(corners)));
  }
  if (pieces.empty()) throw std::invalid_argument("it holds no facet");
  return pieces;
}

}  // namespace lagrain::detail
