// SPDX-License-Identifier: GPL-3.0-or-later
// Frames as PolyData of VTK. A file .pvd is ParaView's list of files and times.
#include "frame_formats.hpp"
#include "poly_data.hpp"

#include <lagrain/laguerre2.hpp>
#include <lagrain/laguerre3.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/wall_shapes.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>

namespace lagrain::detail {
namespace {

namespace fs = std::filesystem;

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

/// Holds all grains, and what of the walls has an end.
template <int Dim>
Eigen::AlignedBox<double, Dim> box_of(const Run<Dim>& run, const Frame<Dim>& frame) {
  Eigen::AlignedBox<double, Dim> box;
  for (Eigen::Index i = 0; i < frame.position.cols(); ++i) {
    const Vec<Dim> half = Vec<Dim>::Constant(frame.radius[i]);
    box.extend(frame.position.col(i) - half).extend(frame.position.col(i) + half);
  }
  for (const Wall<Dim>& wall : run.walls()) {
    for (const Vec<Dim>& corner : wall.corners()) box.extend(corner);
    box.extend(wall.point);
  }
  return box;
}

template <int Dim>
std::string walls_file(const Run<Dim>& run, const Frame<Dim>& frame) {
  const auto box = box_of(run, frame);
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

/// The edges of T as lines between centres.
template <int Dim>
std::string edges_file(const Frame<Dim>& frame, Triangulation<Dim>& t) {
  std::vector<double> places, gaps;
  std::vector<std::int64_t> points;
  std::vector<std::int32_t> first, second;
  for (Eigen::Index i = 0; i < frame.position.cols(); ++i)
    add_vector(places, frame.position.col(i));
  for (const auto& [i, j] : t.edges()) {
    points.insert(points.end(), {i, j});
    first.push_back(frame.id[static_cast<std::size_t>(i)]);
    second.push_back(frame.id[static_cast<std::size_t>(j)]);
    const double distance = (frame.position.col(i) - frame.position.col(j)).norm();
    gaps.push_back(distance - frame.radius[i] - frame.radius[j]);
  }
  PolyData mesh(frame.time, frame.id.size());
  mesh.at_cells("i", 1, first);
  mesh.at_cells("j", 1, second);
  mesh.at_cells("gap", 1, gaps);
  mesh.places(places);
  mesh.cells("Lines", points, counted(first.size(), 2, 2));
  return mesh.file();
}

/// Laguerre cells: a polygon for each disc, or the faces of a polyhedron for each sphere.
template <int Dim>
std::string cells_file(const Frame<Dim>& frame, const Triangulation<Dim>& t,
                       const Eigen::AlignedBox<double, Dim>& box) {
  std::vector<double> places;
  std::vector<std::int64_t> ends;
  std::vector<std::int32_t> ids, beyond;
  std::int64_t count = 0;
  const auto add = [&](int i, const Columns<Dim>& corners) {
    if (corners.cols() == 0) return;
    for (Eigen::Index k = 0; k < corners.cols(); ++k) add_vector(places, corners.col(k));
    count += corners.cols();
    ends.push_back(count);
    ids.push_back(frame.id[static_cast<std::size_t>(i)]);
  };
  for (int i = 0; i < t.size(); ++i) {
    if constexpr (Dim == 2) {
      add(i, laguerre_cell(t, i, box));
    } else {
      for (const LaguerreFace& face : laguerre_cell(t, i, box)) {
        add(i, face.corners);
        const auto other = static_cast<std::size_t>(std::max(face.beyond, 0));
        beyond.push_back(face.beyond < 0 ? face.beyond : frame.id[other]);
      }
    }
  }
  PolyData mesh(frame.time, static_cast<std::size_t>(count));
  mesh.at_cells("id", 1, ids);
  if (Dim == 3) mesh.at_cells("beyond", 1, beyond);
  mesh.places(places);
  mesh.cells("Polys", counted(static_cast<std::size_t>(count), 0, 1), ends);
  return mesh.file();
}

}  // namespace

template <int Dim>
void VtkFrames<Dim>::begin(const Run<Dim>&) {
  make_folder(folder_);
  clear(0);
}

template <int Dim>
void VtkFrames<Dim>::persist(const Run<Dim>&, StateVisitor visit, std::int64_t frames) {
  visit(std::string(kinds_.front()) + "_times", times_);
  if (!visit.restores()) return;
  make_folder(folder_);
  clear(frames);
}

template <int Dim>
void VtkFrames<Dim>::clear(std::int64_t first) const {
  std::error_code ignored;
  for (const std::string_view kind : kinds_) {
    remove_numbered(folder_, std::string(kind) + "_", ".vtp", first);
    if (first == 0) fs::remove(folder_ / (std::string(kind) + ".pvd"), ignored);
  }
}

template <int Dim>
void VtkFrames<Dim>::add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) {
  times_.push_back(frame.time);
  add_files(run, frame, number);
}

template <int Dim>
void VtkFrames<Dim>::write(std::string_view kind, std::int64_t number,
                           const std::string& bytes) const {
  write_file(folder_ / numbered(std::string(kind) + "_", number, ".vtp"), bytes);
}

template <int Dim>
void VtkFrames<Dim>::list(std::string_view kind, std::int64_t count) const {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n"
      "<Collection>\n";
  for (std::int64_t k = 0; k < count; ++k) {
    text += "<DataSet timestep=\"" + shortest(times_[static_cast<std::size_t>(k)]) + "\" file=\"" +
            numbered(std::string(kind) + "_", k, ".vtp") + "\"/>\n";
  }
  write_file(folder_ / (std::string(kind) + ".pvd"), text + "</Collection>\n</VTKFile>\n");
}

template <int Dim>
VtpFrames<Dim>::VtpFrames(const fs::path& folder)
    : VtkFrames<Dim>(folder, {"grains", "contacts", "walls"}) {}

template <int Dim>
void VtpFrames<Dim>::add_files(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) {
  const auto contacts = run.contacts();
  this->write("grains", number, grains_file(run, frame, contacts));
  this->list("grains", number + 1);
  if (run.scene().output.contacts) {
    this->write("contacts", number, contacts_file(run, frame, contacts));
    this->list("contacts", number + 1);
  }
  if (run.walls().empty() || (number > 0 && !walls_change(run))) return;
  this->write("walls", number, walls_file(run, frame));
  this->list("walls", walls_change(run) ? number + 1 : 1);
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

template <int Dim>
CellFrames<Dim>::CellFrames(const fs::path& folder) : VtkFrames<Dim>(folder, {"edges", "cells"}) {}

template <int Dim>
void CellFrames<Dim>::add_files(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) {
  // Not the run's: that one stands for where grains were a moment ago, and for wider ones.
  Triangulation<Dim> t;
  t.build(frame.position, frame.radius.array().square().matrix());
  this->write("edges", number, edges_file(frame, t));
  this->list("edges", number + 1);
  this->write("cells", number, cells_file(frame, t, box_of(run, frame)));
  this->list("cells", number + 1);
}

template <int Dim>
double CellFrames<Dim>::bytes_per_frame(const Run<Dim>& run, double) const {
  // Of a bed; each corner is written once for each face that has it.
  constexpr double kEdges = Dim == 2 ? 3 : 7, kCorners = Dim == 2 ? 6 : 70;
  constexpr double kEdge = 16, kCorner = 8 * Dim + 2;  // compressed
  return run.count() * (Dim * sizeof(double) + kEdges * kEdge + kCorners * kCorner);
}

template class VtpFrames<2>;
template class VtpFrames<3>;
template class CellFrames<2>;
template class CellFrames<3>;

}  // namespace lagrain::detail
