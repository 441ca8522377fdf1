// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the triangulations: what an audit finds wrong, as far as it does not depend on
/// the dimension.

#include <lagrain/moving_sites.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::detail {

template <int Dim>
void MovingSites<Dim>::add_defect(std::vector<Defect>& defects, int site, std::string sentence) {
  Defect defect{-1, {}, std::move(sentence)};
  defect.sites.fill(-1);
  defect.sites[0] = site;
  defects.push_back(std::move(defect));
}

/// What is kept beside the simplices comes last: it is checked against simplices that are right.
template <int Dim>
std::vector<typename MovingSites<Dim>::Defect> MovingSites<Dim>::audit() const {
  std::vector<Defect> defects;
  audit_sites(defects);
  if (present_ > 0) {
    audit_vertices(defects);
    self().audit_simplices(defects);
    if (!defects.empty()) return defects;
    self().audit_sphere(defects);
  } else if (topology_.slots() != 0) {
    add_defect(defects, -1, "nothing is present, and something is left");
  }
  if (!defects.empty()) return defects;

  for (const int id : hidden_) {
    const int simplex = self().locate(id, visible_from(id));
    if (topology_.infinite(simplex) || self().conflict(simplex, id)) {
      add_defect(defects, id, "the hidden site has a cell");
    }
  }
  EdgeList found;
  self().find_edges(found);
  if (const std::string wrong = edges_.audit(found); !wrong.empty()) add_defect(defects, -1, wrong);
  if (!std::all_of(site_note_.begin(), site_note_.end(), [](int note) { return note == 0; })) {
    add_defect(defects, -1, "a note of a site is left from an update");
  }
  return defects;
}

/// Checks what is kept of the sites beside the simplices: two copies of their places, what they
/// span, how many are present, which are hidden, and the hints from where to look for these.
template <int Dim>
void MovingSites<Dim>::audit_sites(std::vector<Defect>& defects) const {
  int found = 0;
  std::vector<int> without_cell;
  for (int id = 0; id < size_; ++id) {
    if (sites_[index(id)] != before_[index(id)]) {
      add_defect(defects, id, "two copies of the place differ");
    }
    if (topology_.corner_of(id) != Topology::kNone) ++found;
    if (topology_.corner_of(id) <= -2) without_cell.push_back(id);
  }
  if (found != present_) add_defect(defects, -1, "the number of present sites is wrong");
  if (without_cell != hidden_) add_defect(defects, -1, "the list of hidden sites is wrong");
  for (const int id : without_cell) {
    // Hints lead to a site that is seen, or to one that has been removed.
    int at = id;
    for (int step = 0; step <= size_ && at >= 0 && at < size_ && topology_.corner_of(at) <= -2;
         ++step) {
      at = -2 - topology_.corner_of(at);
    }
    if (at < 0 || at >= size_ + auxiliary_sites() || topology_.corner_of(at) <= -2) {
      add_defect(defects, id, "the hints of the hidden site lead nowhere");
    }
  }
  Simplex simplex{};
  if (span_of(present_sites(), simplex) != dimension_) {
    add_defect(defects, -1, "the dimension is wrong");
  }
  if (last_ < 0 || last_ > size_) {
    add_defect(defects, -1, "the search for the next site begins nowhere");
  }
}

/// Checks that vertices and corners know each other, and that the free slots are the dead ones,
/// each once: the next simplex goes there.
template <int Dim>
void MovingSites<Dim>::audit_vertices(std::vector<Defect>& defects) const {
  for (int id = -1; id < size_ + auxiliary_sites(); ++id) {
    const int corner = topology_.corner_of(id);
    if (corner < 0 && id >= 0 && id < size_) continue;
    if (corner < 0 || corner >> 2 >= topology_.slots() || !topology_.alive(corner >> 2) ||
        topology_.vertex(corner) != id) {
      add_defect(defects, id, "the corner of the site belongs to another");
    }
  }
  std::vector<int> free(topology_.free_slots().begin(), topology_.free_slots().end()), dead;
  for (int slot = 0; slot < topology_.slots(); ++slot) {
    if (!topology_.alive(slot)) dead.push_back(slot);
  }
  std::sort(free.begin(), free.end());
  if (free != dead) add_defect(defects, -1, "the list of free slots is wrong");
}

}  // namespace lagrain::detail
