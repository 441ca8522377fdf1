// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/triangulation2.hpp>

#include "updates.hpp"

#include <algorithm>

namespace lagrain {

// ---- Decisions ---------------------------------------------------------------------------------

/// Returns true for infinite triangles and for strictly counter-clockwise ones.
bool Triangulation<2>::positive(const Site2* places, int a, int b, int c) const {
  return (a | b | c) < 0 || orientation(places[a], places[b], places[c]) > 0;
}

/// Returns true if the triangle cannot belong to T because of the site; see predicates2.hpp.
bool Triangulation<2>::conflict(int triangle, int site) const {
  const auto [a, b, c] = corners_of(triangle);
  if ((a | b | c) >= 0) return in_conflict(sites_.data(), a, b, c, site);
  if (a < 0) return in_conflict_beyond(sites_.data(), b, c, site);
  if (b < 0) return in_conflict_beyond(sites_.data(), c, a, site);
  return in_conflict_beyond(sites_.data(), a, b, site);
}

/// Returns true if neither of the two triangles at the edge opposite to a corner is in conflict
/// with the apex of the other. A hull edge is always regular: only one of its apices is finite.
bool Triangulation<2>::locally_regular(int corner) const {
  const int apex = topology_.vertex(corner), opposite = topology_.vertex(topology_.twin(corner));
  return (apex | opposite) < 0 || !conflict(corner >> 2, opposite);
}

/// Returns true if the hull has one lexicographic minimum: a closed chain that never turns right
/// and has one is a convex polygon.
bool Triangulation<2>::hull_goes_round_once() const {
  const auto before = [&](int i, int j) {
    const Site2 &a = sites_[index(i)], &b = sites_[index(j)];
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  };
  int minima = 0;
  topology_.for_each_corner(Topology2::kInfinite, [&](int corner) {
    const int last = topology_.source(corner), here = topology_.target(corner);
    const int next = topology_.target(topology_.turn(corner));
    minima += before(here, last) && before(here, next);
  });
  return minima == 1;
}

/// Returns a visible site that shares an edge with a visible one, or with infinity.
int Triangulation<2>::finite_neighbour(int site) const {
  const int corner = topology_.corner_of(site);
  return topology_.source(corner) >= 0 ? topology_.source(corner) : topology_.target(corner);
}

/// Lists the finite edges from nothing, auxiliary sites left out.
void Triangulation<2>::find_edges(EdgeList& list) const {
  list.find(size_, [&](auto&& f) {
    for (int t = 0; t < topology_.slots(); ++t) {
      const auto v = topology_.vertices(t);
      // An edge runs once each way; negative vertices (infinite, or of a dead slot) drop out, and
      // so do auxiliary sites, whose ids are the highest.
      if (v[0] >= 0 && v[0] < v[1] && v[1] < size_) f(v[0], v[1]);
      if (v[1] >= 0 && v[1] < v[2] && v[2] < size_) f(v[1], v[2]);
      if (v[2] >= 0 && v[2] < v[0] && v[0] < size_) f(v[2], v[0]);
    }
  });
}

// ---- Flips -------------------------------------------------------------------------------------

/// Replaces the edge opposite to a corner by the other diagonal of its two triangles.
void Triangulation<2>::flip(int corner) {
  edges_.note_gone(topology_.source(corner), topology_.target(corner));
  const int other = topology_.flip(corner);
  edges_.note_made(topology_.vertex(corner), topology_.vertex(other));
  ++report_.flips;
  if (topology_.infinite(corner >> 2) || topology_.infinite(other >> 2)) hull_touched_ = true;
}

/// Takes a site of degree three out of the topology; returns the remaining triangle.
int Triangulation<2>::take_out_degree3(int site) {
  topology_.for_each_corner(site,
                            [&](int corner) { edges_.note_gone(site, topology_.source(corner)); });
  const int left = topology_.remove_degree3(site);
  ++report_.flips;
  if (topology_.infinite(left)) hull_touched_ = true;
  return left;
}

/// Takes out the reflex end of an edge that is not regular and cannot be flipped.
///
/// Let a, b be the ends of the edge, c and d its apices, and a the reflex end. Then a lies in the
/// triangle b, c, d, and, as the edge is not regular, the lifted a lies above the plane of the
/// lifted b, c, d: site a is hidden for good.
/// @return false if T was no triangulation
bool Triangulation<2>::unstick(int corner) {
  const int site = reflex_end(corner);
  const int hint = finite_neighbour(site);
  touched_.clear();
  if (!remove_by_flips(site, sites_.data())) return false;
  hide(site, hint);
  ++report_.unstuck;
  for (const int triangle : touched_) {
    if (topology_.alive(triangle)) push_simplex(triangle);
  }
  return true;
}

/// Returns the finite end of an edge at which its two triangles together turn by 180 degrees or
/// more, or -1 if there is none.
int Triangulation<2>::reflex_end(int corner) const {
  const int c = topology_.vertex(corner), d = topology_.vertex(topology_.twin(corner));
  const int a = topology_.source(corner), b = topology_.target(corner);
  if (!positive(sites_.data(), c, a, d)) return a;
  if (!positive(sites_.data(), d, b, c)) return b;
  return -1;
}

/// Makes an edge that is not locally regular go away, and puts the edges around on the queue. The
/// flip is 2-2, or 3-1 where the reflex end has degree three, or 4-2 where it has degree four and
/// lies between the apices. Only finite triangles have to come out positive.
/// @return false if none of these flips will do
bool Triangulation<2>::resolve(int corner) {
  const int site = reflex_end(corner);
  if (site < 0) {
    flip(corner);
    const int other = topology_.twin(topology_.next(corner));
    push(corner);
    push(topology_.prev(corner));
    push(topology_.next(other));  // the apex stayed at prev(other)
    push(topology_.prev(other));
    return true;
  }
  const int degree = topology_.degree(site, 5);
  if (degree > 4) return false;
  if (degree == 4) {
    const int c = topology_.vertex(corner), d = topology_.vertex(topology_.twin(corner));
    const auto at = [&](int id) { return sites_[index(id)]; };
    if (orientation(at(c), at(site), at(d)) != 0) return false;
    flip(corner);  // leaves a flat triangle for the time of one statement
  }
  const int hint = finite_neighbour(site);
  const int left = take_out_degree3(site);
  hide(site, hint);
  push_simplex(left);
  if (degree == 4) {
    for (int i = 0; i < 3; ++i) push_simplex(topology_.twin(4 * left + i) >> 2);
  }
  return true;
}

/// Flips until T is regular, given that all triangles are positive.
/// @param moved  T is regular but for the edges at these sites and at the triangles in touched_
/// @param sweep  whether to look at all edges instead, in the order in which they lie in memory
bool Triangulation<2>::flip_to_regular(std::span<const int> moved, bool sweep) {
  start_flips();
  if (sweep) {
    for (int t = 0; t < topology_.slots(); ++t) {
      if (!topology_.alive(t)) continue;
      for (int corner = 4 * t; corner < 4 * t + 3; ++corner) {
        if (topology_.twin(corner) < corner || locally_regular(corner)) continue;
        push(corner);
        if (!drain()) return false;
        if (!topology_.alive(t)) break;
      }
    }
  } else {
    for (const int triangle : touched_) {
      if (topology_.alive(triangle)) push_simplex(triangle);
    }
    for (const int site : moved) {
      if (topology_.corner_of(site) < 0) continue;
      topology_.for_each_corner(site, [&](int corner) {
        push(corner);
        push(topology_.prev(corner));
      });
      if (!drain()) return false;
    }
  }
  return settle() && (!hull_touched_ || hull_goes_round_once());
}

/// Makes T regular after the sites in moved_ have moved.
bool Triangulation<2>::repair() {
  // From this share of moved sites on, one sweep over all triangles costs less than one star after
  // the other, which overlap and lie scattered in memory. Measured on the jittered lattices of
  // tests/bench/bench_update.cpp, with 1,000 to 50,000 discs: the two cost the same at 1/8, and the
  // sweep a tenth to a fifth less at 1/4. With twice the share an update of up to half of the sites
  // takes up to twice as long; with half the share nothing changes. No result depends on it.
  constexpr std::size_t kSweptShare = 4;
  const bool sweep = moved_.size() > index(size_) / kSweptShare;
  return extract_inverted(moved_, sweep) && flip_to_regular(moved_, sweep);
}

// ---- Taking out --------------------------------------------------------------------------------

/// Takes a site out by flips of its own edges, and adds the triangles that it made to touched_.
///
/// In any triangulation with a convex hull this succeeds. An edge of a site inside can be flipped
/// until three are left: of the ears of its link at least two do not hold the site. Four with the
/// site on a diagonal are the flat case. A site on the hull loses the ears of its fan, and then the
/// fan itself.
/// @return false if the rest would be flat, or T is no triangulation; T is then half done
bool Triangulation<2>::remove_by_flips(int site, const Site2* places) {
  // Entry k stands for the edge to ring_[k]; spokes_[k] is the corner at `site` in the triangle on
  // the left of this edge.
  ring_.clear();
  spokes_.clear();
  topology_.for_each_corner(site, [&](int corner) {
    ring_.push_back(topology_.source(corner));
    spokes_.push_back(corner);
  });
  const auto neighbour = [&](std::size_t k) { return ring_[k % ring_.size()]; };
  const auto flip_spoke = [&](std::size_t k) {
    k %= ring_.size();
    const int corner = spokes_[k];
    const int other = spokes_[(k + ring_.size() - 1) % ring_.size()];
    flip(topology_.prev(corner));
    touched_.push_back(corner >> 2);
    touched_.push_back(other >> 2);
    spokes_[(k + ring_.size() - 1) % ring_.size()] = corner;
    ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(k));
    spokes_.erase(spokes_.begin() + static_cast<std::ptrdiff_t>(k));
  };
  // Returns the first k whose neighbours p, u, q make an ear beyond u, with the site on the given
  // side of p, q.
  const auto find_ear = [&](int side) {
    const std::size_t n = ring_.size();
    std::size_t k = 0;
    for (; k < n; ++k) {
      const int p = neighbour(k + n - 1), u = neighbour(k), q = neighbour(k + 1);
      if ((p | u | q) >= 0 && orientation(places[p], places[u], places[q]) > 0 &&
          orientation(places[site], places[p], places[q]) == side) {
        break;
      }
    }
    return k;
  };

  while (ring_.size() > 3) {
    const std::size_t n = ring_.size();
    std::size_t k = find_ear(1);
    if (k == n && n == 4) k = find_ear(0);
    if (k == n) {
      const auto infinity = static_cast<std::size_t>(
          std::find(ring_.begin(), ring_.end(), Topology2::kInfinite) - ring_.begin());
      if (infinity == n) return false;
      if (!topology_.on_hull(neighbour(infinity + 2))) {
        k = infinity + 1;
      } else if (!topology_.on_hull(neighbour(infinity + n - 2))) {
        k = infinity + n - 1;
      } else {
        return false;
      }
    }
    flip_spoke(k);
  }
  for (const int corner : spokes_) {
    const bool beyond = topology_.vertex(topology_.twin(corner)) < 0;
    const bool on_hull = (ring_[0] | ring_[1] | ring_[2]) < 0;
    if (beyond && on_hull) return false;
  }
  topology_.set_corner_of(site, spokes_[0]);
  touched_.push_back(take_out_degree3(site));
  return true;
}

/// Takes a visible site out of a regular T, and makes it regular again.
bool Triangulation<2>::take_out_at_rest(int site) {
  return remove_by_flips(site, sites_.data()) && flip_to_regular({}, false);
}

/// Makes the hull convex again around the triangles in touched_ from `first` on.
void Triangulation<2>::close_hull(std::size_t first, const Site2* places) {
  for (std::size_t k = first; k < touched_.size(); ++k) {
    const int triangle = touched_[k];
    if (!topology_.alive(triangle) || !topology_.infinite(triangle)) continue;
    for (int corner = 4 * triangle; corner < 4 * triangle + 3; ++corner) {
      const int other = topology_.twin(corner);
      const int a = topology_.source(corner), b = topology_.target(corner);
      if (a >= 0 && b >= 0) continue;
      const int c = topology_.vertex(corner), d = topology_.vertex(other);
      const bool reflex = a >= 0 ? orientation(places[c], places[a], places[d]) > 0
                                 : orientation(places[d], places[b], places[c]) > 0;
      if (!reflex) continue;
      flip(corner);
      touched_.push_back(triangle);
      touched_.push_back(other >> 2);
      break;
    }
  }
}

/// Returns the corner of an inverted triangle whose vertex crossed the hull edge outwards, or
/// kNone. That vertex joins the hull when the triangle is dropped, which is cheap, and the usual
/// case along a flat floor.
int Triangulation<2>::crossed_hull_edge(int triangle) const {
  int found = Topology2::kNone;
  for (int corner = 4 * triangle; corner < 4 * triangle + 3; ++corner) {
    if (topology_.vertex(topology_.twin(corner)) >= 0) continue;
    if (found != Topology2::kNone) return Topology2::kNone;
    found = corner;
  }
  if (found == Topology2::kNone) return found;
  const Site2 &a = sites_[index(topology_.source(found))],
              &b = sites_[index(topology_.target(found))];
  const Site2& c = sites_[index(topology_.vertex(found))];
  const double from_a = (c.x - a.x) * (b.x - a.x) + (c.y - a.y) * (b.y - a.y);
  const double from_b = (c.x - b.x) * (a.x - b.x) + (c.y - b.y) * (a.y - b.y);
  const bool between = from_a > 0 && from_b > 0;
  return between && !topology_.on_hull(topology_.vertex(found)) ? found : Topology2::kNone;
}

/// Takes out moved sites, at their old places, until no triangle is inverted at the new ones.
bool Triangulation<2>::extract_inverted(std::span<const int> moved, bool sweep) {
  touched_.clear();
  inverted_.clear();
  hull_touched_ = sweep;
  const auto list_if_inverted = [&](int triangle) {
    const auto [a, b, c] = corners_of(triangle);
    if (!positive(sites_.data(), a, b, c)) inverted_.push_back(triangle);
  };
  if (sweep) {
    for (int t = 0; t < topology_.slots(); ++t) list_if_inverted(t);
  } else {
    topology_.clear_marks();
    for (const int site : moved) {
      if (topology_.corner_of(site) < 0) continue;
      topology_.for_each_corner(site, [&](int corner) {
        if (topology_.source(corner) < 0) hull_touched_ = true;
        const int triangle = corner >> 2;
        if (topology_.marked(triangle)) return;
        topology_.set_mark(triangle);
        list_if_inverted(triangle);
      });
    }
  }

  // Lists what is left of inverted_, and what is inverted of the triangles made since.
  const auto list_again = [&](std::size_t first) {
    pending_.swap(inverted_);
    inverted_.clear();
    topology_.clear_marks();
    const auto list_once = [&](int triangle) {
      if (!topology_.alive(triangle) || topology_.marked(triangle)) return;
      topology_.set_mark(triangle);
      list_if_inverted(triangle);
    };
    for (const int triangle : pending_) list_once(triangle);
    for (std::size_t k = first; k < touched_.size(); ++k) list_once(touched_[k]);
  };

  const auto take_out_cover = [&] {
    for (const int site : cover_) {
      const int hint = finite_neighbour(site);
      const std::size_t start = touched_.size();
      if (!remove_by_flips(site, before_.data())) return false;
      hide(site, hint);
      ++report_.extracted;
      close_hull(start, before_.data());
    }
    return true;
  };

  for (bool may_drop = true;;) {
    const std::size_t first = touched_.size();
    const auto hard = std::partition(inverted_.begin(), inverted_.end(), [&](int triangle) {
      return may_drop && crossed_hull_edge(triangle) != Topology2::kNone;
    });
    if (hard == inverted_.end()) {
      const bool all = std::all_of(inverted_.begin(), inverted_.end(), [&](int triangle) {
        const int corner = crossed_hull_edge(triangle);
        if (corner == Topology2::kNone) return false;
        touched_.push_back(triangle);
        touched_.push_back(topology_.twin(corner) >> 2);
        flip(corner);
        return true;
      });
      cover_.clear();
      if (hull_touched_) choose_folded();
      if (all && cover_.empty()) return true;
      // One drop put the inner vertex of the next on the hull, or the hull is folded. The next
      // sites leave at the old places, so take the drops back.
      may_drop = false;
      close_hull(first, before_.data());
    } else {
      const auto easy = static_cast<std::size_t>(hard - inverted_.begin());
      choose_cover(std::span<const int>(inverted_).subspan(easy));
    }
    if (!take_out_cover()) return false;
    list_again(first);
  }
}

/// Adds to cover_ moved sites at which the hull turns right by more than 90 degrees, or their moved
/// neighbours along the hull. Such a hull may cross itself, and flips would not unfold it. The
/// measure may be rough, because a hull that slips through fails the last test.
void Triangulation<2>::choose_folded() {
  topology_.for_each_corner(Topology2::kInfinite, [&](int corner) {
    const int last = topology_.source(corner), here = topology_.target(corner);
    const int next = topology_.target(topology_.turn(corner));
    const Site2 &a = sites_[index(last)], &p = sites_[index(here)], &b = sites_[index(next)];
    if ((p.x - a.x) * (b.x - p.x) + (p.y - a.y) * (b.y - p.y) > 0) return;
    if (orientation(a, p, b) < 0) return;  // the corners at infinity go round clockwise
    for (const int id : {here, last, next}) {
      if (!moved_place(id)) continue;
      if (std::find(cover_.begin(), cover_.end(), id) == cover_.end()) cover_.push_back(id);
      break;
    }
  });
}

// ---- Putting in --------------------------------------------------------------------------------

/// Finds the triangle that holds the site by a walk over edges that have it strictly beyond; the
/// triangle is infinite if the site lies outside. The walk ends because T is regular.
int Triangulation<2>::locate(int site, int hint) const {
  int triangle = topology_.corner_of(hint) >> 2;
  for (int corner = 4 * triangle; corner < 4 * triangle + 3; ++corner) {
    if (topology_.vertex(corner) < 0) {
      triangle = topology_.twin(corner) >> 2;
      break;
    }
  }
  int came = Topology2::kNone;
  for (bool walking = true; walking && !topology_.infinite(triangle);) {
    walking = false;
    for (int corner = 4 * triangle; corner < 4 * triangle + 3; ++corner) {
      if (corner == came) continue;
      const int a = topology_.source(corner), b = topology_.target(corner);
      if (orientation(sites_[index(a)], sites_[index(b)], sites_[index(site)]) < 0) {
        came = topology_.twin(corner);
        triangle = came >> 2;
        walking = true;
        break;
      }
    }
  }
  return triangle;
}

/// Inserts a site that has no triangle in place of the triangles in conflict with it (Bowyer,
/// Comput. J. 24 (1981) 162; Watson, ibid. 167), and hides the sites among them.
/// @pre T is regular
/// @return false if the site is hidden itself, which then has a fresh hint
bool Triangulation<2>::insert_visible(int site) {
  if (!find_hole(site)) return false;
  // Notes of sites: 2 on the rim of the hole, 1 inside it.
  const auto note = [&](int id) -> int& { return site_note_[index(id)]; };
  for (const int corner : rim_) {
    if (const int id = topology_.source(corner); id >= 0) note(id) = 2;
  }
  ring_.clear();
  for (const int triangle : hole_) {
    for (const int id : topology_.vertices(triangle)) {
      if (id < 0 || note(id) != 0) continue;
      note(id) = 1;
      ring_.push_back(id);
    }
    for (int corner = 4 * triangle; corner < 4 * triangle + 3; ++corner) {
      const int twin = topology_.twin(corner);
      if (corner > twin || !topology_.marked(twin >> 2)) continue;
      edges_.note_gone(topology_.source(corner), topology_.target(corner));
    }
  }
  for (const int corner : rim_) {
    const int id = topology_.source(corner);
    edges_.note_made(site, id);
    if (id >= 0) note(id) = 0;
  }
  topology_.fill_from(site, hole_, rim_);
  for (const int id : ring_) {
    note(id) = 0;
    hide(id, site);
  }
  last_ = site;
  return true;
}

template class detail::MovingSites<2>;

}  // namespace lagrain
