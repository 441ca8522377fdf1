#pragma once
/// @file
/// Private to the triangulations of dim2 and dim3: which sites to take out before a move.

#include <cstddef>
#include <span>
#include <vector>

namespace lagrain::detail {

/// A small set of moved sites with at least one in each of some simplices: where there is a choice,
/// the site that occurs most often, as one that strayed far inverts several.
/// @param vertices  vertices(simplex): a range of ids, negative for none
/// @param moved     moved(id): whether the site may be chosen
/// @param note      by id, all zero before and after
/// @param cover     the set, in order of the simplices; what it held is gone
/// @return          false if a simplex has no site that may be chosen
template <class Vertices, class Moved>
bool choose_cover(std::span<const int> simplices, Vertices&& vertices, Moved&& moved,
                  std::vector<int>& note, std::vector<int>& cover) {
  constexpr int kChosen = -1;
  const auto count = [&](int id) -> int& { return note[static_cast<std::size_t>(id)]; };
  cover.clear();
  bool complete = true;
  for (const int simplex : simplices) {
    for (const int id : vertices(simplex)) {
      if (moved(id)) ++count(id);
    }
  }
  for (const int simplex : simplices) {
    int best = -1;
    bool covered = false;
    for (const int id : vertices(simplex)) {
      if (!moved(id)) continue;
      if (count(id) == kChosen) covered = true;
      if (best < 0 || count(id) > count(best)) best = id;
    }
    complete = complete && best >= 0;
    if (covered || best < 0) continue;
    count(best) = kChosen;
    cover.push_back(best);
  }
  for (const int simplex : simplices) {
    for (const int id : vertices(simplex)) {
      if (id >= 0) count(id) = 0;
    }
  }
  return complete;
}

}  // namespace lagrain::detail
