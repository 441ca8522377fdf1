// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/topology2.hpp>

#include <limits>

namespace lagrain {

void Topology2::relabel(std::span<const int> new_number) {
  for (Triangle& triangle : triangles_) {
    for (int& v : triangle.vertex) {
      if (v >= 0) v = new_number[index(v)];
    }
  }
  std::size_t kept = 1;  // behind the vertex at infinity
  for (std::size_t v = 0; v < new_number.size(); ++v) {
    if (new_number[v] != kNone) corner_of_[kept++] = corner_of_[v + 1];
  }
  corner_of_.resize(kept);
}

void Topology2::clear(int vertices) {
  triangles_.clear();
  free_.clear();
  corner_of_.assign(index(vertices + 1), kNone);
  epoch_ = 1;
}

int Topology2::degree(int v, int limit) const {
  const int first = corner_of(v);
  int corner = first;
  int count = 0;
  do {
    ++count;
    corner = turn(corner);
  } while (corner != first && count < limit);
  return count;
}

bool Topology2::on_hull(int v) const {
  bool found = false;
  for_each_corner(v, [&](int corner) { found = found || source(corner) == kInfinite; });
  return found;
}

void Topology2::clear_marks() {
  if (epoch_ == std::numeric_limits<int>::max()) {
    for (Triangle& triangle : triangles_) triangle.mark = 0;
    epoch_ = 0;
  }
  ++epoch_;
}

void Topology2::renumber(std::span<const int> order) {
  std::vector<int> place(triangles_.size(), kNone);
  for (std::size_t k = 0; k < order.size(); ++k) place[index(order[k])] = static_cast<int>(k);
  std::vector<Triangle> triangles(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    triangles[k] = triangles_[index(order[k])];
    triangles[k].mark = triangles[k].flags = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      int& twin = triangles[k].twin[i];
      twin = 4 * place[index(twin >> 2)] + (twin & 3);
      set_corner_of(triangles[k].vertex[i], static_cast<int>(4 * k + i));
    }
  }
  triangles_.swap(triangles);
  free_.clear();
}

void Topology2::start_from(const std::array<int, 3>& triangle) {
  const auto [a, b, c] = triangle;
  add(a, b, c);
  // Triangle k + 1 lies beyond corner k, and has infinity at its own corner 0.
  add(kInfinite, c, b);
  add(kInfinite, a, c);
  add(kInfinite, b, a);
  for (int k = 0; k < 3; ++k) {
    const int here = 4 * (k + 1), following = 4 * ((k + 1) % 3 + 1);
    link(k, here);
    // They share the edge from infinity to the corner that is neither k nor k + 1.
    link(here + 2, following + 1);
  }
}

int Topology2::add(int a, int b, int c) {
  int triangle = slots();
  if (free_.empty()) {
    triangles_.emplace_back();
  } else {
    triangle = free_.back();
    free_.pop_back();
  }
  Triangle& t = triangles_[index(triangle)];
  t.vertex[0] = a;
  t.vertex[1] = b;
  t.vertex[2] = c;
  t.mark = t.flags = 0;
  set_corner_of(a, 4 * triangle);
  set_corner_of(b, 4 * triangle + 1);
  set_corner_of(c, 4 * triangle + 2);
  return triangle;
}

void Topology2::release(int triangle) {
  Triangle& t = triangles_[index(triangle)];
  t.vertex[0] = t.vertex[1] = t.vertex[2] = kDead;
  free_.push_back(triangle);
}

void Topology2::link(int corner, int other) {
  triangles_[index(corner >> 2)].twin[corner & 3] = other;
  triangles_[index(other >> 2)].twin[other & 3] = corner;
}

int Topology2::flip(int corner) {
  // (c, a, b) and (d, b, a) become (c, a, d) and (d, b, c).
  const int other = twin(corner);
  const int c = vertex(corner), d = vertex(other);
  const int a_to_d = twin(next(other)), b_to_c = twin(next(corner));
  triangles_[index(corner >> 2)].vertex[prev(corner) & 3] = d;
  triangles_[index(other >> 2)].vertex[prev(other) & 3] = c;
  link(corner, a_to_d);
  link(other, b_to_c);
  link(next(corner), next(other));
  set_corner_of(source(corner), next(corner));
  set_corner_of(source(other), next(other));
  return other;
}

int Topology2::remove_degree3(int v) {
  // (v, p, q), (v, q, r), (v, r, p) become (r, p, q) in the place of the first.
  const int first = corner_of(v);
  const int second = turn(first), third = turn(second);
  const int r = target(second);
  const int q_to_r = twin(second), r_to_p = twin(third);
  triangles_[index(first >> 2)].vertex[first & 3] = r;
  link(next(first), q_to_r);
  link(prev(first), r_to_p);
  set_corner_of(r, first);
  set_corner_of(source(first), next(first));
  set_corner_of(target(first), prev(first));
  set_corner_of(v, kNone);
  release(second >> 2);
  release(third >> 2);
  return first >> 2;
}

void Topology2::fill_from(int v, std::span<const int> hole, std::span<const int> rim) {
  rim_.clear();
  for (const int corner : rim) rim_.push_back({source(corner), target(corner), twin(corner)});
  for (const int triangle : hole) release(triangle);
  for (const Rim& edge : rim_) link(4 * add(v, edge.source, edge.target), edge.outside);
  // The rim is a cycle: let corner_of(a) name the triangle v, a, b that leaves a, and join each
  // triangle to the one that leaves its end.
  for (const Rim& edge : rim_) set_corner_of(edge.source, next(twin(edge.outside)));
  for (const Rim& edge : rim_) link(next(twin(edge.outside)), next(corner_of(edge.target)));
}

}  // namespace lagrain
