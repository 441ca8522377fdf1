// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The combinatorial layer of the triangulation in space: tetrahedra, neighbours, exchanges of a
/// few of them for others. It knows no coordinates.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace lagrain {

/// A triangulated 3-sphere: the tetrahedra of a triangulation in space, and one infinite
/// tetrahedron over each hull facet, which joins it to the vertex kInfinite. Hull and interior are
/// then the same.
///
/// Tetrahedron t owns the corners 4 t ... 4 t + 3. A corner names three things: the vertex at it,
/// the facet opposite to it, and, by twin(), the corner across that facet. The four vertices
/// stand in positive order. A tetrahedron takes 32 bytes, and 5 for marks; a site of a packing
/// has about six.
class Topology3 {
 public:
  static constexpr int kInfinite = -1;  ///< the vertex at infinity
  static constexpr int kNone = -1;      ///< no corner

  using Quad = std::array<int, 4>;  ///< vertices of a tetrahedron in positive order

  /// Indices of the facet opposite to index i; i and these three, in this order, are positive.
  static constexpr int kFacet[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  /// Indices of the ends of the six edges; edges k and 5 - k are opposite.
  static constexpr int kEdges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

  /// Empties everything; `vertices` finite vertices without a corner.
  void clear(int vertices);
  /// Gives the finite vertices other numbers, in the same order, and takes away those without.
  /// @param new_number  of each vertex; kNone for one that has no corner
  void relabel(std::span<const int> new_number);
  /// One more vertex, without a corner.
  void add_vertex() { corner_of_.push_back(kNone); }
  void reserve(std::size_t count);  ///< makes room for so many tetrahedra

  /// Slots of tetrahedra, dead ones included.
  int slots() const { return static_cast<int>(cells_.size()); }
  /// Tetrahedra, infinite ones included.
  int cells() const { return slots() - static_cast<int>(free_.size()); }
  /// Whether a slot holds a tetrahedron.
  bool alive(int cell) const { return cells_[index(cell)].vertex[0] != kDead; }

  /// The vertex at a corner.
  int vertex(int corner) const { return cells_[index(corner >> 2)].vertex[corner & 3]; }
  /// The corner across the facet opposite to a corner.
  int twin(int corner) const { return cells_[index(corner >> 2)].twin[corner & 3]; }
  /// The four vertices; all negative and not kInfinite if dead.
  const Quad& vertices(int cell) const { return cells_[index(cell)].vertex; }
  /// Whether it has the vertex kInfinite.
  bool infinite(int cell) const {
    const Quad& v = vertices(cell);
    return (v[0] | v[1] | v[2] | v[3]) < 0;
  }
  /// The corner of a cell at one of its vertices.
  int corner_at(int cell, int v) const {
    const Quad& q = vertices(cell);
    return 4 * cell + (q[0] == v ? 0 : q[1] == v ? 1 : q[2] == v ? 2 : 3);
  }

  /// Any corner at a vertex; negative without one (the owner may keep a note of its own there).
  int corner_of(int v) const { return corner_of_[index(v + 1)]; }
  /// Lets a vertex know one of its corners.
  void set_corner_of(int v, int corner) { corner_of_[index(v + 1)] = corner; }

  /// One step round an edge. The facet opposite to `through` holds the edge; `other` is the second
  /// corner of the cell that is not at it. Both become those of the cell beyond the facet.
  void turn(int& through, int& other) const {
    const int beyond = twin(through);
    through = corner_at(beyond >> 2, vertex(other));
    other = beyond;
  }
  /// Number of cells round the edge opposite to two corners of a cell, but `limit` if there are at
  /// least that many.
  int degree(int corner, int other, int limit) const;
  /// The corners at vertex v, one per cell of its star; uses marks.
  void star(int v, std::vector<int>& corners) const;

  /// Makes one tetrahedron and the four infinite ones round it.
  /// @pre there is none
  void start_from(const Quad& quad);
  /// Puts the cells in another order, without gaps. @param order  every cell once
  void renumber(std::span<const int> order);
  /// Appends a cell (or takes a dead slot); twins are still to be linked.
  int add(const Quad& quad);
  void release(int cell);  ///< frees a slot; twins still point to it
  /// Makes two corners twins.
  void link(int corner, int other) {
    cells_[index(corner >> 2)].twin[corner & 3] = other;
    cells_[index(other >> 2)].twin[other & 3] = corner;
  }

  /// Puts the cells `in` (a ball of at most six vertices) out and the cells `out` (the same ball)
  /// in. The first cells keep the ids of the old ones. Undone by the opposite call, ids included,
  /// if calls are undone in opposite order.
  /// @param made  ids of the new cells; may be `in`
  void exchange(std::span<const int> in, std::span<const Quad> out, std::span<int> made);

  /// Joins vertex v to the boundary of `hole` (a ball of cells, all marked with the present epoch)
  /// in their place. Vertices inside the hole keep a dangling corner: the caller knows them.
  /// @param rim  corners, inside the hole, whose opposite facet bounds it; any order
  void fill_from(int v, std::span<const int> hole, std::span<const int> rim);

  /// Marks: a cell is marked or not, and all marks vanish at once. They are scratch, which whoever
  /// only reads may use.
  /// @{
  void clear_marks() const;
  bool marked(int cell) const { return mark_[index(cell)] == epoch_; }
  void set_mark(int cell) const { mark_[index(cell)] = epoch_; }
  /// @}

  /// Calls f(a, b, inside) once for each edge that has a marked cell around it: its ends, and
  /// whether all cells around it are marked. An edge is what cells turn around, not a pair of
  /// vertices: in a triangulation that is folded two edges may join the same two.
  /// @param cells  the marked cells, each once
  template <class F>
  void for_each_edge_of(std::span<const int> cells, F&& f) const {
    for (const int cell : cells) {
      for (std::size_t k = 0; k < 6; ++k) {
        int through = 4 * cell + kEdges[5 - k][0], other = 4 * cell + kEdges[5 - k][1];
        bool inside = true, least = true;  // of the marked cells around the edge
        for (;;) {
          turn(through, other);
          const int beyond = through >> 2;
          if (beyond == cell) break;
          if (!marked(beyond)) {
            inside = false;
          } else if (beyond < cell) {
            least = false;
            break;
          }
        }
        if (least) f(vertex(4 * cell + kEdges[k][0]), vertex(4 * cell + kEdges[k][1]), inside);
      }
    }
  }

  /// Sets or clears the flag of a corner; returns what it was.
  bool exchange_flag(int corner, bool on) {
    unsigned char& flags = flags_[index(corner >> 2)];
    const auto bit = static_cast<unsigned char>(1 << (corner & 3));
    const bool was = (flags & bit) != 0;
    flags = static_cast<unsigned char>(on ? flags | bit : flags & ~bit);
    return was;
  }
  /// Whether a cell is as it should be between updates: no flag is set, and its mark is of this
  /// epoch or of one before.
  bool at_rest(int cell) const { return flags_[index(cell)] == 0 && mark_[index(cell)] <= epoch_; }
  /// The dead slots, of which the last is taken next.
  std::span<const int> free_slots() const { return free_; }

 private:
  friend struct AuditProbe;
  static constexpr int kDead = -2;
  struct alignas(32) Cell {
    Quad vertex;
    std::array<int, 4> twin;
  };

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  void set(int cell, const Quad& quad);

  std::vector<Cell> cells_;
  mutable std::vector<int> mark_;
  std::vector<unsigned char> flags_;
  std::vector<int> free_;
  std::vector<int> corner_of_;  // of vertex v at v + 1
  mutable int epoch_ = 1;
  std::vector<int> outside_;  // scratch of fill_from()
};

}  // namespace lagrain
