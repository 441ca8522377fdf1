// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The edges of a triangulation as one sorted list, kept up to date by what its updates change.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lagrain {

/// Sorted edges. Flips note what they make and what they take away; when somebody asks for the list
/// it is brought up to date in one pass that costs little more than a copy. Notes count: an edge
/// may come and go, and in a triangulation that is turned inside out for a while two edges may join
/// the same sites.
///
/// Vertices at infinity have negative ids; notes on their edges are ignored. A list that was never
/// found ignores all notes.
class EdgeList {
 public:
  using Edge = std::array<int, 2>;  ///< two sites, the lower id first

  /// Brings the list up to date.
  /// @returns all edges, sorted; good until the next note
  std::span<const Edge> settle() {
    all_new_ = true;
    if (notes_.empty()) return edges_;
    std::sort(notes_.begin(), notes_.end());
    next_.clear();
    next_.reserve(edges_.size() + notes_.size());
    merge(
        notes_, [&](auto first, auto last) { next_.insert(next_.end(), first, last); },
        [&](const Edge& edge) { next_.push_back(edge); });
    edges_.swap(next_);
    notes_.clear();
    return edges_;
  }

  /// Calls f(i, j) for every edge, sorted. Changes nothing: a list with many notes is read faster
  /// after settle().
  template <class F>
  void for_each(F&& f) const {
    std::vector<std::uint64_t> notes = notes_;
    std::sort(notes.begin(), notes.end());
    merge(
        notes,
        [&](auto first, auto last) {
          for (; first != last; ++first) f((*first)[0], (*first)[1]);
        },
        [&](const Edge& edge) { f(edge[0], edge[1]); });
  }

  /// To be called before and after the notes of an update.
  /// @{
  void begin_update() {
    first_new_ = notes_.size();
    all_new_ = false;
    before_.reset();
  }
  void end_update() {
    if (notes_.size() > edges_.size() / 4) settle();
  }
  /// @}
  /// Calls f(i, j) for the edges made since begin_update(), maybe more than once, and maybe for
  /// some that are gone again; for all edges if the list was found anew, or settled, since then.
  template <class F>
  void for_each_new(F&& f) const {
    if (all_new_) {
      for_each(f);
      return;
    }
    for (std::size_t k = first_new_; k < notes_.size(); ++k) {
      if ((notes_[k] & 1) == 0) f(edge_of(notes_[k] >> 1)[0], edge_of(notes_[k] >> 1)[1]);
    }
  }

  /// Gives the sites other ids, in the same order. @param new_id  of each that has an edge
  void relabel(std::span<const int> new_id) {
    settle();
    for (Edge& edge : edges_) {
      for (int& site : edge) site = new_id[static_cast<std::size_t>(site)];
    }
    before_.reset();
  }

  /// Forgets everything: the triangulation is being built anew.
  void clear() {
    live_ = false;
    all_new_ = true;
    notes_.clear();
  }

  /// Lists the edges from nothing: each that for_each(f) gives to f(i, j), as often as it likes, in
  /// any order, of ids in [0, size).
  template <class ForEach>
  void find(int size, ForEach&& for_each) {
    const auto index = [](int i) { return static_cast<std::size_t>(i); };
    // A counting sort by the lower end; then what is left of each row without repetitions is short.
    std::vector<std::size_t> end(index(size) + 2, 0);
    for_each([&](int i, int j) { ++end[index(std::min(i, j)) + 2]; });
    for (std::size_t i = 2; i < end.size(); ++i) end[i] += end[i - 1];
    std::vector<int> other(end.back());
    for_each([&](int i, int j) { other[end[index(std::min(i, j)) + 1]++] = std::max(i, j); });
    edges_.clear();
    std::vector<int> listed_with(index(size), -1);
    for (int i = 0; i < size; ++i) {
      const auto first = static_cast<std::ptrdiff_t>(edges_.size());
      for (std::size_t k = end[index(i)]; k < end[index(i) + 1]; ++k) {
        const int j = other[k];
        if (listed_with[index(j)] == i) continue;
        listed_with[index(j)] = i;
        edges_.push_back({i, j});
      }
      std::sort(edges_.begin() + first, edges_.end());
    }
    live_ = true;
    notes_.clear();
  }

  /// False for a list that ignores notes.
  bool live() const { return live_; }
  /// Notes that an edge between two sites was made, or is gone.
  /// @{
  void note_made(int a, int b) { note(a, b, 0); }
  void note_gone(int a, int b) { note(a, b, 1); }
  /// @}
  /// Notes so far; those after a mark can be taken back, or lose the edges that went and came.
  std::size_t mark() const { return notes_.size(); }
  /// Forgets the notes after a mark.
  void take_back(std::size_t mark) { notes_.resize(std::min(mark, notes_.size())); }
  /// Forgets those after a mark that cancel each other.
  void drop_unchanged(std::size_t mark) {
    const auto first = notes_.begin() + static_cast<std::ptrdiff_t>(mark);
    std::sort(first, notes_.end());
    auto kept = first;
    for_each_change(first, notes_.end(), [&](std::uint64_t key, int count) {
      kept = std::fill_n(kept, std::abs(count), key << 1 | (count < 0 ? 1U : 0U));
    });
    notes_.erase(kept, notes_.end());
  }

  /// Keeps the edges as they are before an update, so that audit() can tell which are new.
  void remember() { before_ = edges(); }

  /// What is wrong with the list, or with what it tells of new edges if remember() was called after
  /// begin_update(); empty if nothing is.
  /// @param found  the edges, found from nothing
  std::string audit(const EdgeList& found) const {
    if (!live_ && !found.edges_.empty()) return "the list of edges knows nothing of updates";
    if (edges() != found.edges_) return "the list of edges is out of date";
    if (!before_) return {};
    std::vector<Edge> told, made;
    for_each_new([&](int i, int j) { told.push_back({i, j}); });
    std::sort(told.begin(), told.end());
    std::set_difference(found.edges_.begin(), found.edges_.end(), before_->begin(), before_->end(),
                        std::back_inserter(made));
    if (!std::includes(told.begin(), told.end(), made.begin(), made.end()))
      return "an edge is not told to be new";
    return {};
  }

 private:
  friend struct AuditProbe;

  static Edge edge_of(std::uint64_t key) {
    return {static_cast<int>(key >> 32), static_cast<int>(key & 0xffffffffU)};
  }

  /// Calls f(key, count) for each edge that sorted notes made more often than they took it away, or
  /// less often: by `count`.
  template <class Note, class F>
  static void for_each_change(Note first, Note last, F&& f) {
    while (first != last) {
      const std::uint64_t key = *first >> 1;
      int count = 0;
      for (; first != last && *first >> 1 == key; ++first) count += (*first & 1) == 0 ? 1 : -1;
      if (count != 0) f(key, count);
    }
  }

  /// The edges as sorted notes leave them, in increasing order: run(first, last) for those of
  /// edges_ that stay, and made(edge) for those that are new.
  template <class Run, class Made>
  void merge(const std::vector<std::uint64_t>& notes, Run&& run, Made&& made) const {
    auto old = edges_.cbegin();
    for_each_change(notes.cbegin(), notes.cend(), [&](std::uint64_t key, int count) {
      const Edge edge = edge_of(key);
      const auto place = std::lower_bound(old, edges_.cend(), edge);
      run(old, place);
      old = place;
      if (count > 0) {
        made(edge);
      } else {
        ++old;
      }
    });
    run(old, edges_.cend());
  }

  std::vector<Edge> edges() const {
    std::vector<Edge> list;
    for_each([&](int i, int j) { list.push_back({i, j}); });
    return list;
  }

  /// One number that sorts by edge; the lowest bit tells which kind of note it is.
  void note(int a, int b, unsigned gone) {
    if (!live_ || (a | b) < 0) return;
    const auto i = static_cast<std::uint64_t>(std::min(a, b));
    const auto j = static_cast<std::uint64_t>(std::max(a, b));
    notes_.push_back((i << 32 | j) << 1 | gone);
  }

  std::vector<Edge> edges_;
  std::vector<Edge> next_;  // scratch
  std::vector<std::uint64_t> notes_;
  bool all_new_ = true;
  std::size_t first_new_ = 0;
  bool live_ = false;
  std::optional<std::vector<Edge>> before_;
};

}  // namespace lagrain
