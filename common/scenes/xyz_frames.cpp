// SPDX-License-Identifier: GPL-3.0-or-later
// Extended XYZ, as libAtoms and ASE define it: for each frame the number of grains, a line that
// says what the columns are, and a line for each grain. OVITO and ASE read it.
#include "frame_formats.hpp"

#include <lagrain/numbers.hpp>

#include <string>

namespace lagrain::detail {
namespace {

template <class V>
void add_vector(std::string& text, const V& v) {
  for (Eigen::Index d = 0; d < v.size(); ++d) text += ' ' + shortest(v[d]);
  if (v.size() == 2) text += " 0";
}

}  // namespace

template <int Dim>
void XyzFrames<Dim>::begin(const Run<Dim>&) {
  file_.emplace(name_);
}

template <int Dim>
void XyzFrames<Dim>::persist(const Run<Dim>&, StateVisitor visit, std::int64_t) {
  std::int64_t length = 0;
  if (!visit.restores()) {
    file_->sync_to_disk();  // a checkpoint must not count on more than the disk has
    length = static_cast<std::int64_t>(file_->length());
  }
  visit("xyz_bytes", length);
  if (visit.restores()) file_.emplace(name_, static_cast<std::uintmax_t>(length));
}

template <int Dim>
void XyzFrames<Dim>::add_frame(const Run<Dim>&, const Frame<Dim>& frame, std::int64_t) {
  std::string text = std::to_string(frame.id.size()) +
                     "\nProperties=id:I:1:material:I:1:pos:R:3:velo:R:3:radius:R:1";
  if (frame.spin) text += ":angular_velocity:R:3";
  text +=
      " Time=" + shortest(frame.time) + " Step=" + std::to_string(frame.step) + " pbc=\"F F F\"\n";
  for (Eigen::Index i = 0; i < frame.position.cols(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    text += std::to_string(frame.id[k]) + ' ' + std::to_string(frame.material[k]);
    add_vector(text, frame.position.col(i));
    add_vector(text, frame.velocity.col(i));
    text += ' ' + shortest(frame.radius[i]);
    if (frame.spin) {
      if (Dim == 2) text += " 0 0";
      for (const double component : frame.spin->col(i)) text += ' ' + shortest(component);
    }
    text += '\n';
  }
  file_->add(text);
}

template <int Dim>
double XyzFrames<Dim>::bytes_per_frame(const Run<Dim>& run, double) const {
  const int numbers = 2 * Dim + 1 + (run.spins() != nullptr ? kSpinDim<Dim> : 0);
  constexpr double kWords = 14;  // id, material, zeros of the plane
  return run.count() * (numbers * kTextBytes + kWords);
}

template class XyzFrames<2>;
template class XyzFrames<3>;

}  // namespace lagrain::detail
