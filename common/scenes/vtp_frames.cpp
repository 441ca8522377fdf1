// SPDX-License-Identifier: GPL-3.0-or-later
// Frames as PolyData of VTK in XML, for ParaView and OVITO. A file has a head that says which
// arrays there are, and the arrays behind it, raw and compressed by zlib in blocks ("VTK XML
// Formats" of the VTK documentation). A file .pvd is ParaView's list of files and times.
#include "frame_formats.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/wall_shapes.hpp>

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace lagrain::detail {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kKinds{"grains", "contacts", "walls"};

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

/// Points with numbers, and the cells between them.
class PolyData {
 public:
  PolyData(double time, std::size_t points) : time_(time), points_(points) {}

  /// A number, or a vector, for each point or cell.
  template <class Number>
  static std::string numbers(std::string_view name, int components,
                             const std::vector<Number>& values, std::string& data) {
    constexpr const char* type = std::is_same_v<Number, double> ? "Float64"
                                 : sizeof(Number) == 8          ? "Int64"
                                                                : "Int32";
    std::string text = "<DataArray type=\"" + std::string(type) + "\" Name=\"" + std::string(name) +
                       "\" NumberOfComponents=\"" + std::to_string(components) +
                       "\" format=\"appended\" offset=\"" + std::to_string(data.size()) + "\"/>\n";
    data +=
        compressed({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number)});
    return text;
  }
  template <class Number>
  void at_points(std::string_view name, int components, const std::vector<Number>& values) {
    at_points_ += numbers(name, components, values, data_);
  }
  template <class Number>
  void at_cells(std::string_view name, int components, const std::vector<Number>& values) {
    at_cells_ += numbers(name, components, values, data_);
  }
  /// @param places  three numbers for each point [m]
  void places(const std::vector<double>& places) { places_ = numbers("Points", 3, places, data_); }
  /// @param kind  "Verts", "Lines" or "Polys"
  /// @param ends  for each cell, where its points end in the list
  void cells(std::string_view kind, const std::vector<std::int64_t>& points,
             const std::vector<std::int64_t>& ends) {
    cell_kind_ = kind;
    cell_count_ = ends.size();
    cells_ = numbers("connectivity", 1, points, data_);
    cells_ += numbers("offsets", 1, ends, data_);
  }

  std::string file() const {
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

 private:
  double time_;  // [s]
  std::size_t points_;
  std::string at_points_, at_cells_, places_;
  std::string cell_kind_, cells_;
  std::size_t cell_count_ = 0;
  std::string data_;
};

/// Adds a vector of the plane or of space as three numbers.
template <class V>
void add_vector(std::vector<double>& to, const V& v) {
  for (Eigen::Index d = 0; d < 3; ++d) to.push_back(d < v.size() ? v[d] : 0);
}

/// begin, begin + step, begin + 2 step, ...
std::vector<std::int64_t> counted(std::size_t count, std::int64_t begin, std::int64_t step) {
  std::vector<std::int64_t> list(count);
  for (std::size_t k = 0; k < count; ++k) list[k] = begin + step * static_cast<std::int64_t>(k);
  return list;
}

template <int Dim>
std::string grains_file(const Run<Dim>& run, const Frame<Dim>& frame,
                        const std::vector<ContactRecord<Dim>>& contacts) {
  const std::size_t n = frame.id.size();
  std::vector<double> places, velocities, spins;
  for (Eigen::Index i = 0; i < frame.position.cols(); ++i) {
    add_vector(places, frame.position.col(i));
    add_vector(velocities, frame.velocity.col(i));
    if (!frame.spin) continue;
    if constexpr (Dim == 2) {
      add_vector(spins, Vec<3>(0, 0, (*frame.spin)(0, i)));
    } else {
      add_vector(spins, frame.spin->col(i));
    }
  }
  std::vector<std::int32_t> coordination(n, 0);
  for (const ContactRecord<Dim>& contact : contacts) {
    ++coordination[static_cast<std::size_t>(contact.i)];
    if (contact.wall < 0) ++coordination[static_cast<std::size_t>(contact.j)];
  }
  PolyData mesh(frame.time, n);
  mesh.at_points("radius", 1, std::vector<double>(frame.radius.begin(), frame.radius.end()));
  mesh.at_points("velocity", 3, velocities);
  if (frame.spin) mesh.at_points("spin", 3, spins);
  mesh.at_points("id", 1, frame.id);
  mesh.at_points("material", 1, frame.material);
  mesh.at_points("group", 1, run.groups());
  mesh.at_points("coordination", 1, coordination);
  mesh.places(places);
  mesh.cells("Verts", counted(n, 0, 1), counted(n, 1, 1));
  return mesh.file();
}

/// Each contact as a line from the grain's centre to its partner's, or to the wall.
template <int Dim>
std::string contacts_file(const Run<Dim>& run, const Frame<Dim>& frame,
                          const std::vector<ContactRecord<Dim>>& contacts) {
  std::vector<double> places, forces, sizes, overlaps;
  std::vector<std::int32_t> first, second, walls;
  for (const ContactRecord<Dim>& contact : contacts) {
    const Vec<Dim> centre = frame.position.col(contact.i);
    add_vector(places, centre);
    if (contact.wall < 0) {
      add_vector(places, frame.position.col(contact.j));
    } else {
      const Vec<Dim> foot = centre - (frame.radius[contact.i] - contact.overlap) * contact.normal;
      add_vector(places, foot);
    }
    add_vector(forces, contact.force);
    sizes.push_back(contact.force.norm());
    overlaps.push_back(contact.overlap);
    first.push_back(run.id(contact.i));
    second.push_back(contact.wall < 0 ? run.id(contact.j) : -1);
    walls.push_back(contact.wall);
  }
  PolyData mesh(frame.time, 2 * contacts.size());
  mesh.at_cells("force", 3, forces);
  mesh.at_cells("force_magnitude", 1, sizes);
  mesh.at_cells("overlap", 1, overlaps);
  mesh.at_cells("i", 1, first);
  mesh.at_cells("j", 1, second);
  mesh.at_cells("wall", 1, walls);
  mesh.places(places);
  mesh.cells("Lines", counted(2 * contacts.size(), 0, 1), counted(contacts.size(), 2, 2));
  return mesh.file();
}

template <int Dim>
std::string walls_file(const Run<Dim>& run, const Frame<Dim>& frame) {
  Eigen::AlignedBox<double, Dim> box;
  for (Eigen::Index i = 0; i < frame.position.cols(); ++i) {
    const Vec<Dim> half = Vec<Dim>::Constant(frame.radius[i]);
    box.extend(frame.position.col(i) - half).extend(frame.position.col(i) + half);
  }
  for (const Wall<Dim>& wall : run.walls()) {
    for (const Vec<Dim>& corner : wall.corners()) box.extend(corner);
    box.extend(wall.point);
  }
  std::vector<double> places;
  std::vector<std::int64_t> points, ends;
  std::vector<std::int32_t> walls;
  for (std::size_t w = 0; w < run.walls().size(); ++w) {
    for (const auto& facet : facets_of(run.walls()[w], box)) {
      for (const Vec<Dim>& corner : facet) {
        points.push_back(static_cast<std::int64_t>(points.size()));
        add_vector(places, corner);
      }
      ends.push_back(static_cast<std::int64_t>(points.size()));
      walls.push_back(static_cast<std::int32_t>(w));
    }
  }
  PolyData mesh(frame.time, points.size());
  mesh.at_cells("wall", 1, walls);
  mesh.places(places);
  mesh.cells(Dim == 2 ? "Lines" : "Polys", points, ends);
  return mesh.file();
}

template <int Dim>
bool walls_change(const Run<Dim>& run) {
  return std::any_of(run.walls().begin(), run.walls().end(), [](const Wall<Dim>& wall) {
    return wall.moves() || std::isfinite(wall.until);
  });
}

}  // namespace

template <int Dim>
void VtpFrames<Dim>::begin(const Run<Dim>&) {
  make_folder(folder_);
  clear(0);
}

template <int Dim>
void VtpFrames<Dim>::persist(const Run<Dim>&, StateVisitor visit, std::int64_t frames) {
  visit("vtp_times", times_);
  if (!visit.restores()) return;
  make_folder(folder_);
  clear(frames);
}

template <int Dim>
void VtpFrames<Dim>::clear(std::int64_t first) const {
  std::error_code ignored;
  for (const std::string_view kind : kKinds) {
    remove_numbered(folder_, std::string(kind) + "_", ".vtp", first);
    if (first == 0) fs::remove(folder_ / (std::string(kind) + ".pvd"), ignored);
  }
}

template <int Dim>
void VtpFrames<Dim>::add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) {
  const auto write = [&](std::string_view kind, const std::string& text) {
    write_file(folder_ / numbered(std::string(kind) + "_", number, ".vtp"), text);
  };
  times_.push_back(frame.time);
  const auto contacts = run.contacts();
  write(kKinds[0], grains_file(run, frame, contacts));
  list(kKinds[0], times_.size());
  if (run.scene().output.contacts) {
    write(kKinds[1], contacts_file(run, frame, contacts));
    list(kKinds[1], times_.size());
  }
  if (run.walls().empty() || (number > 0 && !walls_change(run))) return;
  write(kKinds[2], walls_file(run, frame));
  list(kKinds[2], walls_change(run) ? times_.size() : 1);
}

/// Lists the files of the first frames.
template <int Dim>
void VtpFrames<Dim>::list(std::string_view kind, std::size_t count) const {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n"
      "<Collection>\n";
  for (std::size_t k = 0; k < count; ++k) {
    text += "<DataSet timestep=\"" + shortest(times_[k]) + "\" file=\"" +
            numbered(std::string(kind) + "_", static_cast<std::int64_t>(k), ".vtp") + "\"/>\n";
  }
  write_file(folder_ / (std::string(kind) + ".pvd"), text + "</Collection>\n</VTKFile>\n");
}

template <int Dim>
double VtpFrames<Dim>::bytes_per_frame(const Run<Dim>& run, double contacts) const {
  // In the plane a third of the numbers are zeros, which zlib makes short.
  const int numbers = 2 * Dim + 1 + (run.spins() != nullptr ? kSpinDim<Dim> : 0);
  constexpr double kNumber = sizeof(double), kWholeNumbers = 8;  // the latter are short as well
  double bytes = run.count() * (numbers * kNumber + kWholeNumbers);
  if (run.scene().output.contacts) bytes += contacts * (3 * Dim + 3) * kNumber;
  return bytes;
}

template class VtpFrames<2>;
template class VtpFrames<3>;

}  // namespace lagrain::detail
