// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the triangulations: the steps of an update that do not depend on the dimension.

#include "site_order.hpp"

#include <lagrain/check.hpp>
#include <lagrain/moving_sites.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace lagrain::detail {

// ---- Arguments ---------------------------------------------------------------------------------

template <int Dim>
void expect_finite(const Vec<Dim>& place, double weight, int id) {
  const auto numbers = [&] {
    std::string text;
    for (const double x : place) text += (text.empty() ? "" : ", ") + std::to_string(x);
    return text;
  };
  LAGRAIN_EXPECTS(place.allFinite() && std::isfinite(weight),
                  "site " + std::to_string(id) + " is not finite: (" + numbers() +
                      ") with weight " + std::to_string(weight));
}

inline void expect_same_size(Eigen::Index columns, Eigen::Index weights) {
  LAGRAIN_EXPECTS(columns == weights,
                  std::to_string(columns) + " sites with " + std::to_string(weights) + " weights");
}

// ---- Updates -----------------------------------------------------------------------------------

template <int Dim>
void MovingSites<Dim>::build(const Columns<Dim>& sites, const Eigen::VectorXd& weights) {
  expect_same_size(sites.cols(), weights.size());
  const auto count = static_cast<int>(sites.cols());
  for (int i = 0; i < count; ++i) expect_finite<Dim>(sites.col(i), weights[i], i);
  restart(count);
  for (int i = 0; i < count; ++i) {
    sites_[index(i)] = site_at(sites.col(i), weights[i]);
    topology_.set_corner_of(i, -2);  // a note that says "present"; rebuild() replaces it
  }
  self().rebuild();
  before_ = sites_;
  expect_valid();
}

template <int Dim>
UpdateReport MovingSites<Dim>::move(std::span<const int> moved, const Columns<Dim>& sites,
                                    const Eigen::VectorXd& weights) {
  expect_same_size(sites.cols(), weights.size());
  LAGRAIN_EXPECTS(sites.cols() == size_,
                  std::to_string(sites.cols()) + " columns for " + std::to_string(size_) + " ids");
  for (const int id : moved) {
    LAGRAIN_EXPECTS(contains(id), "site " + std::to_string(id) + " is not present");
    expect_finite<Dim>(sites.col(id), weights[id], id);
  }
  begin();
  moved_.resize(moved.size());
  std::size_t count = 0;
  for (const int id : moved) {
    const Site place = site_at(sites.col(id), weights[id]);
    if (place == sites_[index(id)]) continue;  // also drops repetitions
    sites_[index(id)] = place;
    moved_[count++] = id;
  }
  moved_.resize(count);
  if (moved_.empty()) return finish();
  if (self().tiny()) {
    self().rebuild();
  } else if (self().repair()) {
    try_hidden();
  } else {
    ++report_.rebuilds;
    self().rebuild();
  }
  for (const int id : moved_) before_[index(id)] = sites_[index(id)];
  return finish();
}

template <int Dim>
UpdateReport MovingSites<Dim>::insert(int id, const Vec<Dim>& position, double weight) {
  LAGRAIN_EXPECTS(id >= 0 && id <= size_ && !contains(id),
                  "cannot insert site " + std::to_string(id) + ", size " + std::to_string(size_));
  expect_finite<Dim>(position, weight, id);
  begin();
  if (id == size_) {
    // Auxiliary sites have the ids above; a set that has some is built anew in any case.
    ++size_;
    sites_.resize(index(size_ + Dim));
    before_.resize(index(size_ + Dim));
    site_note_.resize(index(size_ + Dim), 0);
    topology_.add_vertex();
  }
  sites_[index(id)] = before_[index(id)] = site_at(position, weight);
  topology_.set_corner_of(id, -2 - last_);
  ++present_;
  if (self().tiny()) {
    self().rebuild();
  } else if (!self().insert_visible(id)) {
    hidden_.push_back(id);
  }
  return finish();
}

template <int Dim>
UpdateReport MovingSites<Dim>::remove(int id) {
  LAGRAIN_EXPECTS(contains(id), "site " + std::to_string(id) + " is not present");
  begin();
  --present_;
  if (topology_.corner_of(id) <= -2) {
    topology_.set_corner_of(id, Topology::kNone);
    std::erase(hidden_, id);
    return finish();
  }
  touched_.clear();
  hull_touched_ = false;
  // Where T is tiny a build is the ordinary way, which is no rung of the ladder.
  const bool tiny = self().tiny();
  if (!tiny && self().take_out_at_rest(id)) {
    try_hidden();
  } else {
    report_.rebuilds += tiny ? 0 : 1;
    topology_.set_corner_of(id, Topology::kNone);
    self().rebuild();
  }
  return finish();
}

template <int Dim>
void MovingSites<Dim>::close_gaps() {
  // Ids keep their order, so ties are broken as before, and sorted lists stay sorted.
  std::vector<int> new_id(index(size_ + Dim), Topology::kNone);
  int count = 0;
  for (int id = 0; id < size_ + Dim; ++id) {
    if (id >= size_ || contains(id)) new_id[index(id)] = count++;
  }
  count -= Dim;
  if (count == size_) return;
  std::vector<int> hints;
  for (const int id : hidden_) {
    const int hint = hint_of(id);
    hints.push_back(new_id[index(contains(hint) ? hint : visible_from(id))]);
  }
  topology_.relabel(new_id);
  edges_.relabel(new_id);
  for (int id = 0; id < size_ + Dim; ++id) {
    if (new_id[index(id)] < 0) continue;
    sites_[index(new_id[index(id)])] = sites_[index(id)];
    before_[index(new_id[index(id)])] = before_[index(id)];
  }
  sites_.resize(index(count + Dim));
  before_.resize(index(count + Dim));
  site_note_.resize(index(count + Dim));
  for (std::size_t k = 0; k < hidden_.size(); ++k) {
    hidden_[k] = new_id[index(hidden_[k])];
    topology_.set_corner_of(hidden_[k], -2 - hints[k]);
  }
  last_ = std::max(0, new_id[index(last_)]);
  size_ = count;
  expect_valid();
}

template <int Dim>
void MovingSites<Dim>::begin() {
  report_ = {};
  edges_.begin_update();
  if constexpr (kAudited) edges_.remember();
}

template <int Dim>
UpdateReport MovingSites<Dim>::finish() {
  std::sort(hidden_.begin(), hidden_.end());
  edges_.end_update();
  expect_valid();
  return report_;
}

/// Does nothing, unless lagrain was built to audit itself.
template <int Dim>
void MovingSites<Dim>::expect_valid() const {
  if constexpr (kAudited) {
    if (const auto defects = self().audit(); !defects.empty()) {
      throw AuditError("Triangulation<" + std::to_string(Dim) + ">: " + defects.front().sentence);
    }
  }
}

// ---- Building ----------------------------------------------------------------------------------

/// Forgets everything, and makes room for sites of which nothing is known yet.
template <int Dim>
void MovingSites<Dim>::restart(int count) {
  size_ = present_ = count;
  sites_.resize(index(count + Dim));
  site_note_.assign(index(count + Dim), 0);
  hidden_.clear();
  topology_.clear(count + Dim);
}

/// Lists the present sites in increasing order.
template <int Dim>
std::vector<int> MovingSites<Dim>::present_sites() const {
  std::vector<int> present;
  present.reserve(index(present_));
  for (int id = 0; id < size_; ++id) {
    if (contains(id)) present.push_back(id);
  }
  return present;
}

/// Builds T from nothing.
template <int Dim>
void MovingSites<Dim>::rebuild_by_insertion() {
  // Up to so many sites are inserted in the order of their ids. Measured with builds of the
  // jittered lattices of tests/bench/bench_update.cpp, whose ids are in a good order: at 64 sites
  // sorting costs 40 % of such a build in the plane and 20 % in space. That is what half the
  // number would cost sets of 32 to 64 sites; twice the number lets the walks of up to 128 sites
  // cross the set.
  constexpr std::size_t kSorted = 64;
  std::vector<int> order = present_sites();
  const auto place = [&](int id) { return site(id); };
  const bool sorted = order.size() > kSorted;
  if (sorted) sort_in_rounds<Dim>(order, place);
  topology_.clear(size_ + Dim);
  topology_.reserve(Parts::kSimplices * order.size());
  edges_.clear();
  hidden_.clear();
  last_ = 0;
  insert_all(order, nullptr);
  if (sorted) {
    sort_along_curve<Dim>(order, place);
    sort_simplices(order);
  }
  std::sort(hidden_.begin(), hidden_.end());
  self().find_edges(edges_);
}

/// Builds from nothing by inserting the sites of `order`, one after the other. An insertion into a
/// regular triangulation always succeeds, and ties are ours from the first on.
/// @param away  auxiliary sites keep to the other side of a plane of sites than this one, unless it
///              is null
template <int Dim>
void MovingSites<Dim>::insert_all(std::span<const int> order, const Site* away) {
  Simplex simplex;
  dimension_ = span_of(order, simplex);
  if (dimension_ < 0) return;
  if (dimension_ < Dim) place_auxiliaries(simplex, away);
  if (orientation_of(simplex) < 0) std::swap(simplex[0], simplex[1]);
  topology_.start_from(simplex);
  last_ = simplex[0];
  for (const int id : order) {
    if (std::find(simplex.begin(), simplex.end(), id) != simplex.end()) continue;
    topology_.set_corner_of(id, -2 - last_);
    if (!self().insert_visible(id)) hidden_.push_back(id);
  }
}

/// Returns the dimension of what some sites span, and puts the first of them that span a line, a
/// plane, space into `simplex`.
template <int Dim>
int MovingSites<Dim>::span_of(std::span<const int> sites, Simplex& simplex) const {
  const auto at = [&](int k) -> const Site& { return sites_[index(simplex[index(k)])]; };
  int dimension = -1;
  for (const int id : sites) {
    if (dimension == Dim) break;
    simplex[index(dimension + 1)] = id;
    const bool raises = dimension == -1  ? true
                        : dimension == 0 ? place_of(at(0)) != place_of(at(1))
                        : dimension == 1 ? !Parts::collinear(at(0), at(1), at(2))
                                         : orientation_of(simplex) != 0;
    if (raises) ++dimension;
  }
  return dimension;
}

/// Returns the sign of a simplex of Dim + 1 sites.
template <int Dim>
int MovingSites<Dim>::orientation_of(const Simplex& simplex) const {
  std::array<const Site*, Dim + 1> places;
  std::transform(simplex.begin(), simplex.end(), places.begin(),
                 [&](int id) { return &sites_[index(id)]; });
  return Parts::orientation(places);
}

/// Completes a simplex of dimension_ + 1 sites by auxiliary ones, each displaced from the first
/// along an axis.
template <int Dim>
void MovingSites<Dim>::place_auxiliaries(Simplex& simplex, const Site* away) {
  const int first = dimension_ + 1;
  double size = 1;
  for (int k = 0; k < first; ++k) {
    size = std::max(size, site(simplex[index(k)]).cwiseAbs().maxCoeff());
  }
  // One of the choices of axes, each of them and those that follow it in turn, leads out of the
  // span of the sites. The displacement is as long as any coordinate, so that rounding does not
  // swallow it, and towards zero, so that nothing overflows.
  double Site::*axis = nullptr;
  for (int choice = 0; choice < Dim; ++choice) {
    for (int k = first; k <= Dim; ++k) {
      axis = Parts::kAxes[index((choice + k - first) % Dim)];
      simplex[index(k)] = size_ + k - first;
      Site& auxiliary = sites_[index(simplex[index(k)])];
      auxiliary = sites_[index(simplex[0])];
      auxiliary.*axis += auxiliary.*axis > 0 ? -size : size;
      auxiliary.w = 0;
    }
    if (orientation_of(simplex) != 0) break;
  }
  if (away == nullptr || first != Dim) return;
  std::array<const Site*, Dim + 1> beyond;
  std::transform(simplex.begin(), simplex.end(), beyond.begin(),
                 [&](int id) { return &sites_[index(id)]; });
  beyond.back() = away;
  if (orientation_of(simplex) == Parts::orientation(beyond)) {
    // To the other side, and no further than doubles go.
    constexpr double kMost = std::numeric_limits<double>::max();
    const double from = sites_[index(simplex[0])].*axis;
    sites_[index(simplex.back())].*axis =
        std::clamp(from > 0 ? from + size : from - size, -kMost, kMost);
  }
}

/// Fills hole_ with the simplices in conflict with a site that has none, all of them marked, and
/// rim_ with their corners opposite to the others. They hang together, so a walk finds one, and
/// the rest are found from neighbour to neighbour.
/// @pre T is regular
/// @return false if there is none: the site is hidden, and has a fresh hint
template <int Dim>
bool MovingSites<Dim>::find_hole(int site) {
  const int start = self().locate(site, visible_from(site));
  if (!topology_.infinite(start) && !self().conflict(start, site)) {
    topology_.set_corner_of(site, -2 - topology_.vertex(4 * start));
    return false;
  }
  topology_.clear_marks();
  topology_.set_mark(start);
  hole_.assign(1, start);
  rim_.clear();
  for (std::size_t k = 0; k < hole_.size(); ++k) {
    for (int corner = 4 * hole_[k]; corner <= 4 * hole_[k] + Dim; ++corner) {
      const int beyond = topology_.twin(corner) >> 2;
      if (topology_.marked(beyond)) continue;
      if (self().conflict(beyond, site)) {
        topology_.set_mark(beyond);
        hole_.push_back(beyond);
      } else {
        rim_.push_back(corner);
      }
    }
  }
  return true;
}

/// Puts the simplices into memory in the order of their first site, so that what passes over all of
/// them finds neighbours near each other.
template <int Dim>
void MovingSites<Dim>::sort_simplices(std::span<const int> site_order) {
  std::vector<int> rank(sites_.size(), 0);
  for (std::size_t k = 0; k < site_order.size(); ++k) {
    rank[index(site_order[k])] = static_cast<int>(k);
  }
  std::vector<std::pair<int, int>> keys;
  keys.reserve(index(topology_.slots()));
  for (int simplex = 0; simplex < topology_.slots(); ++simplex) {
    if (!topology_.alive(simplex)) continue;
    int first = std::numeric_limits<int>::max();
    for (const int v : topology_.vertices(simplex)) {
      if (v >= 0) first = std::min(first, rank[index(v)]);
    }
    keys.emplace_back(first, simplex);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<int> order;
  order.reserve(keys.size());
  for (const auto& [first, simplex] : keys) order.push_back(simplex);
  topology_.renumber(order);
}

// ---- Flips -------------------------------------------------------------------------------------

/// Puts the facet opposite to a corner on the queue, once.
template <int Dim>
void MovingSites<Dim>::push(int corner) {
  corner = std::min(corner, topology_.twin(corner));
  if (!topology_.exchange_flag(corner, true)) queue_.push_back(corner);
}

template <int Dim>
void MovingSites<Dim>::push_simplex(int simplex) {
  for (int i = 0; i <= Dim; ++i) push(4 * simplex + i);
}

/// Empties the queue, and allows far more flips from now on than any set of sites was seen to need
/// (about one per simplex): whoever exceeds the number goes round in a circle, as flips may in what
/// is no triangulation, and T is built anew. So a factor of two makes no difference.
template <int Dim>
void MovingSites<Dim>::start_flips() {
  constexpr std::int64_t kFlipsPerSimplex = 64, kFlipsAtLeast = 10000;
  queue_.clear();
  stuck_.clear();
  budget_ = kFlipsPerSimplex * topology_.slots() + kFlipsAtLeast;
}

/// Flips until the queue is empty; facets that cannot be flipped end in stuck_.
/// @return false if the budget is spent, which means that T was no triangulation
template <int Dim>
bool MovingSites<Dim>::drain() {
  while (!queue_.empty()) {
    const int corner = queue_.back();
    queue_.pop_back();
    if (!topology_.alive(corner >> 2) || !topology_.exchange_flag(corner, false)) continue;
    if (self().locally_regular(corner)) continue;
    if (!self().resolve(corner)) stuck_.push_back(corner);
    if (--budget_ < 0) return false;
  }
  return true;
}

/// Drains the queue, and does more where facets stay, until T is locally regular.
template <int Dim>
bool MovingSites<Dim>::settle() {
  for (;;) {
    if (!drain()) return false;
    if (stuck_.empty()) return true;
    const int corner = stuck_.back();
    stuck_.pop_back();
    if (!topology_.alive(corner >> 2) || self().locally_regular(corner) || self().resolve(corner)) {
      continue;
    }
    if (!self().unstick(corner)) return false;
  }
}

// ---- Sites without a simplex -------------------------------------------------------------------

/// Returns a visible site to start from, found along the hints. They go round in no circle, but may
/// be many; a walk from anywhere is then not longer.
template <int Dim>
int MovingSites<Dim>::visible_from(int site) const {
  constexpr int kMostHints = 64;
  int hint = site;
  for (int step = 0; step < kMostHints; ++step) {
    const int note = topology_.corner_of(hint);
    if (note >= 0) return hint;
    if (note == Topology::kNone) break;
    hint = -2 - note;
  }
  return self().finite_neighbour(Topology::kInfinite);
}

/// Tries every hidden site. One pass is enough: an insertion only hides others.
template <int Dim>
void MovingSites<Dim>::try_hidden() {
  pending_.swap(hidden_);
  hidden_.clear();
  for (const int id : pending_) {
    if (self().insert_visible(id)) {
      ++report_.reinserted;
    } else {
      hidden_.push_back(id);
    }
  }
}

/// Fills cover_ with few moved sites, at least one in each of some simplices, in the order of
/// these. Where there is a choice it takes the site that occurs most often, as one that strayed far
/// inverts several.
/// @return false if a simplex has no moved site
template <int Dim>
bool MovingSites<Dim>::choose_cover(std::span<const int> simplices) {
  constexpr int kChosen = -1;
  const auto count = [&](int id) -> int& { return site_note_[index(id)]; };
  cover_.clear();
  bool complete = true;
  for (const int simplex : simplices) {
    for (const int id : topology_.vertices(simplex)) {
      if (moved_place(id)) ++count(id);
    }
  }
  for (const int simplex : simplices) {
    int best = -1;
    bool covered = false;
    for (const int id : topology_.vertices(simplex)) {
      if (!moved_place(id)) continue;
      if (count(id) == kChosen) covered = true;
      if (best < 0 || count(id) > count(best)) best = id;
    }
    complete = complete && best >= 0;
    if (covered || best < 0) continue;
    count(best) = kChosen;
    cover_.push_back(best);
  }
  for (const int simplex : simplices) {
    for (const int id : topology_.vertices(simplex)) {
      if (id >= 0) count(id) = 0;
    }
  }
  return complete;
}

}  // namespace lagrain::detail
