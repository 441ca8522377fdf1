// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/topology3.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace lagrain {

void Topology3::relabel(std::span<const int> new_number) {
  for (Cell& cell : cells_) {
    for (int& v : cell.vertex) {
      if (v >= 0) v = new_number[index(v)];
    }
  }
  std::size_t kept = 1;  // behind the vertex at infinity
  for (std::size_t v = 0; v < new_number.size(); ++v) {
    if (new_number[v] != kNone) corner_of_[kept++] = corner_of_[v + 1];
  }
  corner_of_.resize(kept);
}

void Topology3::clear(int vertices) {
  cells_.clear();
  mark_.clear();
  flags_.clear();
  free_.clear();
  corner_of_.assign(index(vertices + 1), kNone);
  epoch_ = 1;
}

void Topology3::reserve(std::size_t count) {
  cells_.reserve(count);
  mark_.reserve(count);
  flags_.reserve(count);
}

int Topology3::degree(int corner, int other, int limit) const {
  const int first = corner >> 2;
  int count = 0;
  do {
    ++count;
    turn(corner, other);
  } while (corner >> 2 != first && count < limit);
  return count;
}

void Topology3::star(int v, std::vector<int>& corners) const {
  clear_marks();
  corners.assign(1, corner_of(v));
  set_mark(corners[0] >> 2);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const int at = corners[k], cell = at >> 2;
    for (int corner = 4 * cell; corner < 4 * cell + 4; ++corner) {
      if (corner == at) continue;
      const int beyond = twin(corner) >> 2;
      if (marked(beyond)) continue;
      set_mark(beyond);
      corners.push_back(corner_at(beyond, v));
    }
  }
}

void Topology3::clear_marks() const {
  if (epoch_ == std::numeric_limits<int>::max()) {
    std::fill(mark_.begin(), mark_.end(), 0);
    epoch_ = 0;
  }
  ++epoch_;
}

void Topology3::renumber(std::span<const int> order) {
  std::vector<int> place(cells_.size(), kNone);
  for (std::size_t k = 0; k < order.size(); ++k) place[index(order[k])] = static_cast<int>(k);
  std::vector<Cell> cells(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    cells[k] = cells_[index(order[k])];
    for (std::size_t i = 0; i < 4; ++i) {
      int& twin = cells[k].twin[i];
      twin = 4 * place[index(twin >> 2)] + (twin & 3);
      set_corner_of(cells[k].vertex[i], static_cast<int>(4 * k + i));
    }
  }
  cells_.swap(cells);
  mark_.assign(cells_.size(), 0);
  flags_.assign(cells_.size(), 0);
  free_.clear();
}

void Topology3::start_from(const Quad& quad) {
  add(quad);
  for (int i = 0; i < 4; ++i) {
    Quad beyond = quad;
    beyond[index(i)] = kInfinite;
    // Seen from the other side of the facet.
    std::swap(beyond[index(kFacet[i][0])], beyond[index(kFacet[i][1])]);
    link(i, corner_at(add(beyond), kInfinite));
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) {
      link(corner_at(1 + i, quad[index(j)]), corner_at(1 + j, quad[index(i)]));
    }
  }
}

void Topology3::set(int cell, const Quad& quad) {
  cells_[index(cell)] = {quad, {kNone, kNone, kNone, kNone}};
  flags_[index(cell)] = 0;
  for (int i = 0; i < 4; ++i) set_corner_of(quad[index(i)], 4 * cell + i);
}

int Topology3::add(const Quad& quad) {
  int cell = slots();
  if (free_.empty()) {
    cells_.emplace_back();
    mark_.push_back(0);
    flags_.push_back(0);
  } else {
    cell = free_.back();
    free_.pop_back();
    mark_[index(cell)] = 0;
  }
  set(cell, quad);
  return cell;
}

void Topology3::release(int cell) {
  cells_[index(cell)].vertex.fill(kDead);
  free_.push_back(cell);
}

void Topology3::exchange(std::span<const int> in, std::span<const Quad> out, std::span<int> made) {
  // At most six vertices: three bits of a mask name a facet.
  std::array<int, 6> known;
  int count = 0;
  const auto bit = [&](int v) {
    int k = 0;
    while (k < count && known[index(k)] != v) ++k;
    if (k == count) known[index(count++)] = v;
    return 1 << k;
  };
  std::array<int, 64> at;
  at.fill(kNone);
  for (const int cell : in) {
    const Quad& q = vertices(cell);
    int all = 0;
    std::array<int, 4> bits;
    for (std::size_t i = 0; i < 4; ++i) all |= bits[i] = bit(q[i]);
    for (int i = 0; i < 4; ++i) {
      const int beyond = twin(4 * cell + i);
      if (std::find(in.begin(), in.end(), beyond >> 2) == in.end()) {
        at[index(all ^ bits[index(i)])] = beyond;
      }
    }
  }
  std::array<int, 4> ids;
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (k < in.size()) {
      ids[k] = in[k];
      set(ids[k], out[k]);
    } else {
      ids[k] = add(out[k]);
    }
    mark_[index(ids[k])] = 0;
  }
  for (std::size_t k = out.size(); k < in.size(); ++k) release(in[k]);
  for (std::size_t k = 0; k < out.size(); ++k) {
    int all = 0;
    std::array<int, 4> bits;
    for (std::size_t i = 0; i < 4; ++i) all |= bits[i] = bit(out[k][i]);
    for (int i = 0; i < 4; ++i) {
      int& other = at[index(all ^ bits[index(i)])];
      if (other == kNone) {
        other = 4 * ids[k] + i;
      } else {
        link(4 * ids[k] + i, other);
      }
    }
  }
  std::copy_n(ids.begin(), out.size(), made.begin());
}

void Topology3::fill_from(int v, std::span<const int> hole, std::span<const int> rim) {
  // Over each rim facet comes the old cell with v in the place of the corner. While the old cells
  // are still there to turn through, the corner's twin notes the new cell: note(twin) = cell.
  const auto note = [](int cell_or_note) { return -2 - cell_or_note; };
  outside_.clear();
  for (const int corner : rim) {
    outside_.push_back(twin(corner));
    Quad quad = vertices(corner >> 2);
    quad[index(corner & 3)] = v;
    const int cell = add(quad);
    cells_[index(corner >> 2)].twin[index(corner & 3)] = note(cell);
  }
  for (const int corner : rim) {
    const int cell = note(twin(corner));
    for (int i = 0; i < 4; ++i) {
      if (i == (corner & 3) || twin(4 * cell + i) != kNone) continue;
      // Round the edge of the rim facet without vertex i, to the next rim facet.
      int through = (corner & ~3) + i, other = corner;
      while (twin(through) >= 0) turn(through, other);
      link(4 * cell + i, 4 * note(twin(through)) + (other & 3));
    }
  }
  for (std::size_t k = 0; k < rim.size(); ++k) {
    link(4 * note(twin(rim[k])) + (rim[k] & 3), outside_[k]);
  }
  for (const int cell : hole) release(cell);
}

}  // namespace lagrain
