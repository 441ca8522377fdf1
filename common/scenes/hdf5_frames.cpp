// SPDX-License-Identifier: GPL-3.0-or-later
// Frames as HDF5, for Python and whoever else reads tables.
#include "frame_formats.hpp"
#include "hdf5_image.hpp"

#include <string>
#include <utility>
#include <vector>

namespace lagrain::detail {

template <int Dim>
void Hdf5Frames<Dim>::begin(const Run<Dim>&) {
  clear(0);
}

template <int Dim>
void Hdf5Frames<Dim>::persist(const Run<Dim>&, StateVisitor visit, std::int64_t frames) {
  if (visit.restores()) clear(frames);
}

template <int Dim>
void Hdf5Frames<Dim>::clear(std::int64_t first) const {
  make_folder(folder_);
  remove_numbered(folder_, "", ".h5", first);
}

template <int Dim>
void Hdf5Frames<Dim>::add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) {
  using Whole = NumberTable<std::int64_t>;
  using Real = NumberTable<double>;
  State file;
  const auto vectors = [](const auto& matrix) {
    return Real{static_cast<std::size_t>(matrix.rows()),
                {matrix.data(), matrix.data() + matrix.size()}};
  };
  const auto list = [](const auto& numbers) { return Whole{1, {numbers.begin(), numbers.end()}}; };
  file.set("time", Real{1, {frame.time}});
  file.set("step", Whole{1, {frame.step}});
  file.set("id", list(frame.id));
  file.set("position", vectors(frame.position));
  file.set("velocity", vectors(frame.velocity));
  if (frame.spin) file.set("spin", vectors(*frame.spin));
  file.set("radius", Real{1, {frame.radius.begin(), frame.radius.end()}});
  file.set("material", list(frame.material));
  file.set("group", list(run.groups()));
  if (run.scene().output.contacts) {
    Whole first, second, wall;
    Real overlap, normal{Dim, {}}, force{Dim, {}};
    for (const ContactRecord<Dim>& contact : run.contacts()) {
      first.numbers.push_back(run.id(contact.i));
      second.numbers.push_back(contact.wall < 0 ? run.id(contact.j) : -1);
      wall.numbers.push_back(contact.wall);
      overlap.numbers.push_back(contact.overlap);
      normal.numbers.insert(normal.numbers.end(), contact.normal.begin(), contact.normal.end());
      force.numbers.insert(force.numbers.end(), contact.force.begin(), contact.force.end());
    }
    file.set("contacts/i", std::move(first));
    file.set("contacts/j", std::move(second));
    file.set("contacts/wall", std::move(wall));
    file.set("contacts/overlap", std::move(overlap));
    file.set("contacts/normal", std::move(normal));
    file.set("contacts/force", std::move(force));
  }
  write_file(folder_ / numbered("", number, ".h5"), to_hdf5(file));
}

template <int Dim>
double Hdf5Frames<Dim>::bytes_per_frame(const Run<Dim>& run, double contacts) const {
  const int numbers = 2 * Dim + 4 + (run.spins() != nullptr ? kSpinDim<Dim> : 0);
  constexpr double kHead = 8000;  // names and places of the tables
  double bytes = kHead + run.count() * numbers * sizeof(double);
  if (run.scene().output.contacts) bytes += contacts * (2 * Dim + 4) * sizeof(double);
  return bytes;
}

template class Hdf5Frames<2>;
template class Hdf5Frames<3>;

}  // namespace lagrain::detail
