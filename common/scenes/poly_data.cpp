// SPDX-License-Identifier: GPL-3.0-or-later
#include "poly_data.hpp"

#include <lagrain/numbers.hpp>

#include <zlib.h>

#include <bit>
#include <type_traits>

namespace lagrain::detail {
namespace {

void add_bytes(std::string& to, std::uint64_t number) {
  to.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// Bytes as VTK stores them: how many blocks there are, how long each is and the last one is, how
/// long each is compressed, and the blocks.
std::string compressed(std::string_view bytes) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  const std::size_t blocks = (bytes.size() + kBlock - 1) / kBlock;
  std::string head, body, block;
  add_bytes(head, blocks);
  add_bytes(head, kBlock);
  add_bytes(head, bytes.size() % kBlock);
  for (std::size_t k = 0; k < blocks; ++k) {
    const std::string_view part = bytes.substr(k * kBlock, kBlock);
    uLongf size = compressBound(static_cast<uLong>(part.size()));
    block.resize(size);
    // The fastest level: numbers of a simulation hardly become shorter at the others.
    compress2(reinterpret_cast<Bytef*>(block.data()), &size,
              reinterpret_cast<const Bytef*>(part.data()), static_cast<uLong>(part.size()),
              Z_BEST_SPEED);
    add_bytes(head, size);
    body.append(block, 0, size);
  }
  return head + body;
}

}  // namespace

template <class Number>
std::string PolyData::numbers(std::string_view name, int components,
                              const std::vector<Number>& values) {
  constexpr const char* type = std::is_same_v<Number, double> ? "Float64"
                               : sizeof(Number) == 8          ? "Int64"
                                                              : "Int32";
  std::string text = "<DataArray type=\"" + std::string(type) + "\" Name=\"" + std::string(name) +
                     "\" NumberOfComponents=\"" + std::to_string(components) +
                     "\" format=\"appended\" offset=\"" + std::to_string(data_.size()) + "\"/>\n";
  data_ +=
      compressed({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number)});
  return text;
}

void PolyData::cells(std::string_view kind, const std::vector<std::int64_t>& points,
                     const std::vector<std::int64_t>& ends) {
  cell_kind_ = kind;
  cell_count_ = ends.size();
  cells_ = numbers("connectivity", 1, points);
  cells_ += numbers("offsets", 1, ends);
}

std::string PolyData::file() const {
  const auto count_of = [&](std::string_view kind) {
    return " NumberOf" + std::string(kind) + "=\"" +
           std::to_string(kind == cell_kind_ ? cell_count_ : 0) + "\"";
  };
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" ";
  text += std::endian::native == std::endian::little ? "byte_order=\"LittleEndian\""
                                                     : "byte_order=\"BigEndian\"";
  text += " header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n";
  text +=
      "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
      "format=\"ascii\">" +
      shortest(time_) + "</DataArray></FieldData>\n";
  text += "<Piece NumberOfPoints=\"" + std::to_string(points_) + "\"" + count_of("Verts") +
          count_of("Lines") + count_of("Strips") + count_of("Polys") + ">\n";
  text += "<PointData>\n" + at_points_ + "</PointData>\n<CellData>\n" + at_cells_ +
          "</CellData>\n<Points>\n" + places_ + "</Points>\n";
  text += "<" + cell_kind_ + ">\n" + cells_ + "</" + cell_kind_ + ">\n";
  return text + "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_" + data_ +
         "\n</AppendedData>\n</VTKFile>\n";
}

/// begin, begin + step, begin + 2 step, ...
std::vector<std::int64_t> counted(std::size_t count, std::int64_t begin, std::int64_t step) {
  std::vector<std::int64_t> list(count);
  for (std::size_t k = 0; k < count; ++k) list[k] = begin + step * static_cast<std::int64_t>(k);
  return list;
}

template std::string PolyData::numbers(std::string_view, int, const std::vector<double>&);
template std::string PolyData::numbers(std::string_view, int, const std::vector<std::int32_t>&);
template std::string PolyData::numbers(std::string_view, int, const std::vector<std::int64_t>&);

}  // namespace lagrain::detail
