// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The combinatorial layer of the triangulation in the plane: triangles, neighbours, flips. It
/// knows no coordinates.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace lagrain {

/// A triangulated sphere: the triangles of a triangulation in the plane, and one infinite
/// triangle over each hull edge, which joins it to the vertex kInfinite. Hull and interior are
/// then the same.
///
/// Triangle t owns the corners 4 t, 4 t + 1, 4 t + 2 (in the place of a fourth are its mark and
/// flags, so that a triangle fills half a cache line). A corner names three things: the vertex at
/// it, the directed edge opposite to it (counter-clockwise in its triangle), and, by twin(), the
/// corner across that edge. The paper's doubly connected lists keep records for vertices, edges and
/// faces linked by pointers; here an edge has no record (it is a pair of twins), and a site costs
/// 2 * 32 + 4 bytes.
class Topology2 {
 public:
  static constexpr int kInfinite = -1;  ///< the vertex at infinity
  static constexpr int kNone = -1;      ///< no corner

  /// The next corner of the triangle, counter-clockwise.
  static int next(int corner) { return (corner & 3) == 2 ? corner - 2 : corner + 1; }
  /// The previous corner of the triangle.
  static int prev(int corner) { return (corner & 3) == 0 ? corner + 2 : corner - 1; }

  /// Empties everything; `vertices` finite vertices without a corner.
  void clear(int vertices);
  /// Gives the finite vertices other numbers, in the same order, and takes away those without.
  /// @param new_number  of each vertex; kNone for one that has no corner
  void relabel(std::span<const int> new_number);
  /// One more vertex, without a corner.
  void add_vertex() { corner_of_.push_back(kNone); }
  /// Makes room for so many triangles.
  void reserve(std::size_t count) { triangles_.reserve(count); }

  /// Slots of triangles, dead ones included.
  int slots() const { return static_cast<int>(triangles_.size()); }
  /// Triangles, infinite ones included.
  int triangles() const { return slots() - static_cast<int>(free_.size()); }
  /// Whether a slot holds a triangle.
  bool alive(int triangle) const { return triangles_[index(triangle)].vertex[0] != kDead; }

  /// The vertex at a corner.
  int vertex(int corner) const { return triangles_[index(corner >> 2)].vertex[corner & 3]; }
  /// The corner across the edge opposite to a corner.
  int twin(int corner) const { return triangles_[index(corner >> 2)].twin[corner & 3]; }
  /// Ends of the edge opposite to a corner.
  /// @{
  int source(int corner) const { return vertex(next(corner)); }
  int target(int corner) const { return vertex(prev(corner)); }
  /// @}
  /// The three vertices of a triangle, counter-clockwise; all negative and not kInfinite if dead.
  std::span<const int, 3> vertices(int triangle) const {
    return std::span<const int, 3>(triangles_[index(triangle)].vertex);
  }
  /// Whether it has the vertex kInfinite.
  bool infinite(int triangle) const {
    const auto v = vertices(triangle);
    return (v[0] | v[1] | v[2]) < 0;
  }

  /// Any corner at a vertex; negative without one (the owner may keep a note of its own there).
  int corner_of(int v) const { return corner_of_[index(v + 1)]; }
  /// Lets a vertex know one of its corners.
  void set_corner_of(int v, int corner) { corner_of_[index(v + 1)] = corner; }

  /// The corner at the same vertex in the next triangle counter-clockwise.
  int turn(int corner) const { return next(twin(next(corner))); }
  /// Calls f(corner) for each corner at vertex v, counter-clockwise.
  template <class F>
  void for_each_corner(int v, F&& f) const {
    const int first = corner_of(v);
    int corner = first;
    do {
      f(corner);
      corner = turn(corner);
    } while (corner != first);
  }
  /// Number of edges at v, but `limit` if there are at least that many.
  int degree(int v, int limit) const;
  /// True if v has an edge to infinity.
  bool on_hull(int v) const;

  /// Makes one triangle and the three infinite ones round it.
  /// @pre there is none
  void start_from(const std::array<int, 3>& triangle);
  /// Puts the triangles in another order, without gaps. @param order  every triangle once
  void renumber(std::span<const int> order);
  /// Appends a triangle (or takes a dead slot); twins are still to be linked.
  int add(int a, int b, int c);
  void link(int corner, int other);  ///< makes two corners twins

  /// Replaces the edge opposite to `corner` by the other diagonal. The apex stays at `corner`; the
  /// four outer edges are then those opposite to corner, prev(corner) and the same of the other
  /// triangle, whose apex stays at the corner returned.
  int flip(int corner);
  /// Takes out a vertex of degree three; returns the remaining triangle.
  int remove_degree3(int v);
  /// Replaces the triangles of `hole` (a disc) by the star of v. Vertices inside the hole keep a
  /// dangling corner: the caller knows them. The new triangles have v at their corner 0.
  /// @param rim  corners, inside the hole, whose opposite edge bounds it; any order
  void fill_from(int v, std::span<const int> hole, std::span<const int> rim);

  /// Marks: a triangle is marked or not, and all marks vanish at once.
  /// @{
  void clear_marks();
  bool marked(int triangle) const { return triangles_[index(triangle)].mark == epoch_; }
  void set_mark(int triangle) { triangles_[index(triangle)].mark = epoch_; }
  /// @}

  /// Sets or clears the flag of a corner; returns what it was.
  bool exchange_flag(int corner, bool on) {
    int& flags = triangles_[index(corner >> 2)].flags;
    const int bit = 1 << (corner & 3);
    const bool was = (flags & bit) != 0;
    flags = on ? flags | bit : flags & ~bit;
    return was;
  }
  /// Whether a triangle is as it should be between updates: no flag is set, and its mark is of this
  /// epoch or of one before.
  bool at_rest(int triangle) const {
    const Triangle& t = triangles_[index(triangle)];
    return t.flags == 0 && t.mark <= epoch_;
  }
  /// The dead slots, of which the last is taken next.
  std::span<const int> free_slots() const { return free_; }

 private:
  friend struct AuditProbe;
  static constexpr int kDead = -2;
  struct alignas(32) Triangle {
    int vertex[3];
    int mark;
    int twin[3];
    int flags;
  };
  struct Rim {
    int source, target, outside;
  };

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  void release(int triangle);

  std::vector<Triangle> triangles_;
  std::vector<int> free_;
  std::vector<int> corner_of_;  // of vertex v at v + 1
  int epoch_ = 1;
  std::vector<Rim> rim_;  // scratch of fill_from()
};

}  // namespace lagrain
