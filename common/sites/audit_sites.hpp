#pragma once
/// @file
/// Private to the triangulations of dim2 and dim3: what an audit finds in the book-keeping of
/// sites.

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace lagrain::detail {

/// Checks what is kept of the sites beside the simplices: two copies of their places, how many are
/// present, which are hidden, and the hints from where to look for these. A site without a corner
/// has a note instead: Topology::kNone if it is not present, -2 - hint if it is hidden.
/// @param size        ids; those from here on belong to auxiliary sites
/// @param auxiliary   their number
/// @param report      report(site or -1, sentence)
template <class Topology, class Site, class Report>
void audit_sites(const Topology& topology, int size, int auxiliary, std::span<const Site> sites,
                 std::span<const Site> before, int present, std::span<const int> hidden,
                 Report&& report) {
  int found = 0;
  std::vector<int> without_cell;
  for (int id = 0; id < size; ++id) {
    const auto k = static_cast<std::size_t>(id);
    if (sites[k] != before[k]) report(id, "two copies of the place differ");
    if (topology.corner_of(id) != Topology::kNone) ++found;
    if (topology.corner_of(id) <= -2) without_cell.push_back(id);
  }
  if (found != present) report(-1, "the number of present sites is wrong");
  if (without_cell != std::vector<int>(hidden.begin(), hidden.end())) {
    report(-1, "the list of hidden sites is wrong");
  }
  for (const int id : without_cell) {
    // Hints lead to a site that is seen, or to one that has been removed.
    int at = id;
    for (int step = 0; step <= size && at >= 0 && at < size && topology.corner_of(at) <= -2;
         ++step) {
      at = -2 - topology.corner_of(at);
    }
    if (at < 0 || at >= size + auxiliary || topology.corner_of(at) <= -2) {
      report(id, "the hints of the hidden site lead nowhere");
    }
  }
}

/// Whether the free slots of a topology are its dead ones, each once: the next simplex goes there.
template <class Topology>
bool free_slots_are_dead(const Topology& topology) {
  std::vector<int> free(topology.free_slots().begin(), topology.free_slots().end()), dead;
  for (int slot = 0; slot < topology.slots(); ++slot) {
    if (!topology.alive(slot)) dead.push_back(slot);
  }
  std::sort(free.begin(), free.end());
  return free == dead;
}

}  // namespace lagrain::detail
