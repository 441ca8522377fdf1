#include <lagrain/triangulation2.hpp>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace lagrain {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase =
    CGAL::Triangulation_vertex_base_with_info_2<int, Kernel,
                                                CGAL::Regular_triangulation_vertex_base_2<Kernel>>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Regular_triangulation_face_base_2<Kernel>>;
using Oracle =
    CGAL::Regular_triangulation_2<Kernel,
                                  CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;

/// True if all sites lie on one line; looks no further than the first that does not.
bool on_one_line(const std::vector<Site2>& sites, const std::vector<int>& ids) {
  const auto at = [&](int id) -> const Site2& { return sites[static_cast<std::size_t>(id)]; };
  const auto apart = [&](int id) { return at(id).x != at(ids[0]).x || at(id).y != at(ids[0]).y; };
  const auto second = std::find_if(ids.begin(), ids.end(), apart);
  return std::all_of(second, ids.end(),
                     [&](int id) { return orientation(at(ids[0]), at(*second), at(id)) == 0; });
}

}  // namespace

void Triangulation<2>::rebuild() {
  std::vector<int> present;
  present.reserve(index(present_));
  for (int id = 0; id < size(); ++id) {
    if (contains(id)) present.push_back(id);
  }
  topology_.clear(size());
  edges_.clear();
  hidden_.clear();
  line_.clear();
  last_ = 0;
  if (on_one_line(sites_, present)) {
    rebuild_line(present);
  } else {
    rebuild_plane(present);
  }
  find_edges(edges_);
}

void Triangulation<2>::find_edges(EdgeList& list) const {
  list.find(size(), [&](auto&& f) {
    for (std::size_t k = 1; k < line_.size(); ++k) f(line_[k - 1], line_[k]);
    for (int t = 0; t < topology_.slots(); ++t) {
      const auto v = topology_.vertices(t);
      // An edge runs once each way; negative vertices (infinite, or of a dead slot) drop out.
      if (v[0] >= 0 && v[0] < v[1]) f(v[0], v[1]);
      if (v[1] >= 0 && v[1] < v[2]) f(v[1], v[2]);
      if (v[2] >= 0 && v[2] < v[0]) f(v[2], v[0]);
    }
  });
}

/// The lower hull of the lifted sites by one scan along the line.
void Triangulation<2>::rebuild_line(const std::vector<int>& present) {
  std::vector<int> order = present;
  const auto key = [&](int id) { return std::pair(sites_[index(id)].x, sites_[index(id)].y); };
  // At one place the least height h = -w + const comes first, on a tie the higher id (eps is
  // least).
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    if (key(i) != key(j)) return key(i) < key(j);
    const double wi = sites_[index(i)].w, wj = sites_[index(j)].w;
    return wi != wj ? wi > wj : i > j;
  });
  for (const int id : order) {
    if (!line_.empty() && key(line_.back()) == key(id)) {
      hidden_.push_back(id);
      continue;
    }
    // The last one leaves when the newcomer is below the line through the last two.
    while (line_.size() >= 2 &&
           detail::conflict_on_line(sites_.data(), line_[line_.size() - 2], line_.back(), id)) {
      hidden_.push_back(line_.back());
      line_.pop_back();
    }
    line_.push_back(id);
  }
  for (std::size_t k = 0; k < line_.size(); ++k)
    topology_.set_corner_of(line_[k], static_cast<int>(k));
  for (const int id : hidden_) topology_.set_corner_of(id, -2 - line_.front());
  std::sort(hidden_.begin(), hidden_.end());
  dimension_ = std::min(static_cast<int>(line_.size()), 2) - 1;
}

/// CGAL builds (its ties broken by coordinates), one pass of flips brings the result to our tie
/// rule.
void Triangulation<2>::rebuild_plane(const std::vector<int>& present) {
  dimension_ = 2;
  std::vector<std::pair<Oracle::Weighted_point, int>> points;
  points.reserve(present.size());
  for (const int id : present) {
    const Site2& s = sites_[index(id)];
    points.emplace_back(Oracle::Weighted_point(Oracle::Bare_point(s.x, s.y), s.w), id);
  }
  Oracle built;
  built.insert(points.begin(), points.end());

  built.infinite_vertex()->info() = Topology2::kInfinite;
  topology_.reserve_triangles(built.tds().number_of_full_dim_faces());
  for (auto f = built.all_faces_begin(); f != built.all_faces_end(); ++f) {
    f->info() = topology_.add(f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info());
  }
  for (auto f = built.all_faces_begin(); f != built.all_faces_end(); ++f) {
    for (int i = 0; i < 3; ++i) {
      const int twin = 4 * f->neighbor(i)->info() + built.tds().mirror_index(f, i);
      if (twin > 4 * f->info() + i) topology_.link(4 * f->info() + i, twin);
    }
  }
  for (auto v = built.hidden_vertices_begin(); v != built.hidden_vertices_end(); ++v) {
    const auto f = v->face();
    const int hint = f->vertex(0)->info() >= 0 ? f->vertex(0)->info() : f->vertex(1)->info();
    hide(v->info(), hint);
  }

  for (const int id : present) {
    if (!contains(id)) hide(id, topology_.source(topology_.corner_of(Topology2::kInfinite)));
  }

  const UpdateReport outer = report_;
  touched_.clear();
  hull_touched_ = false;
  flip_to_regular({}, true);
  try_hidden();
  report_ = outer;  // the flips of a build are no update's
  std::sort(hidden_.begin(), hidden_.end());
}

}  // namespace lagrain
