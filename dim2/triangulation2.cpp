#include <lagrain/triangulation2.hpp>

#include <lagrain/check.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace lagrain {

namespace {

void expect_finite(double x, double y, double w, int id) {
  LAGRAIN_EXPECTS(std::isfinite(x) && std::isfinite(y) && std::isfinite(w),
                  "site " + std::to_string(id) + " is not finite: (" + std::to_string(x) + ", " +
                      std::to_string(y) + ") with weight " + std::to_string(w));
}

void expect_same_size(Eigen::Index columns, Eigen::Index weights) {
  LAGRAIN_EXPECTS(columns == weights,
                  std::to_string(columns) + " sites with " + std::to_string(weights) + " weights");
}

}  // namespace

// corner_of(site) when it is not visible: kNone if not present, -2 - hint if hidden.
bool Triangulation<2>::contains(int id) const {
  return id >= 0 && id < size() && topology_.corner_of(id) != Topology2::kNone;
}

void Triangulation<2>::build(const Columns<2>& sites, const Eigen::VectorXd& weights) {
  expect_same_size(sites.cols(), weights.size());
  const auto n = static_cast<int>(sites.cols());
  for (int i = 0; i < n; ++i) expect_finite(sites(0, i), sites(1, i), weights[i], i);
  sites_.resize(index(n));
  for (int i = 0; i < n; ++i) sites_[index(i)] = {sites(0, i), sites(1, i), weights[i]};
  site_epoch_.assign(index(n), 0);
  site_count_.assign(index(n), 0);
  topology_.clear(n);
  // A note that says "present"; rebuild() replaces it.
  for (int i = 0; i < n; ++i) topology_.set_corner_of(i, -2);
  present_ = n;
  rebuild();
  before_ = sites_;
  expect_valid();
}

UpdateReport Triangulation<2>::move(std::span<const int> moved, const Columns<2>& sites,
                                    const Eigen::VectorXd& weights) {
  expect_same_size(sites.cols(), weights.size());
  LAGRAIN_EXPECTS(sites.cols() == size(),
                  std::to_string(sites.cols()) + " columns for " + std::to_string(size()) + " ids");
  for (const int id : moved) {
    LAGRAIN_EXPECTS(contains(id), "site " + std::to_string(id) + " is not present");
    expect_finite(sites(0, id), sites(1, id), weights[id], id);
  }
  begin();
  moved_.clear();
  for (const int id : moved) {
    const Site2 place{sites(0, id), sites(1, id), weights[id]};
    if (place == sites_[index(id)]) continue;  // also drops repetitions
    sites_[index(id)] = place;
    moved_.push_back(id);
  }
  if (moved_.empty()) return finish();
  if (tiny()) {
    rebuild();
  } else {
    // Many stars overlap and lie scattered in memory; then one sweep over all triangles is cheaper.
    const bool sweep = moved_.size() > index(size()) / 4;
    const bool done = extract_inverted(moved_, sweep) && flip_to_regular(moved_, sweep);
    if (done) {
      try_hidden();
    } else {
      ++report_.rebuilds;
      rebuild();
    }
  }
  for (const int id : moved_) before_[index(id)] = sites_[index(id)];
  return finish();
}

UpdateReport Triangulation<2>::insert(int id, const Vec<2>& position, double weight) {
  LAGRAIN_EXPECTS(id >= 0 && id <= size() && !contains(id),
                  "cannot insert site " + std::to_string(id) + ", size " + std::to_string(size()));
  expect_finite(position[0], position[1], weight, id);
  begin();
  if (id == size()) {
    if (id == 0) topology_.clear(0);  // the infinite vertex
    sites_.emplace_back();
    before_.emplace_back();
    site_epoch_.push_back(0);
    site_count_.push_back(0);
    topology_.add_vertex();
  }
  sites_[index(id)] = before_[index(id)] = {position[0], position[1], weight};
  topology_.set_corner_of(id, -2 - last_);
  ++present_;
  if (tiny()) {
    rebuild();
  } else if (!insert_visible(id)) {
    hidden_.push_back(id);
  }
  return finish();
}

UpdateReport Triangulation<2>::remove(int id) {
  LAGRAIN_EXPECTS(contains(id), "site " + std::to_string(id) + " is not present");
  begin();
  --present_;
  if (topology_.corner_of(id) <= -2) {
    topology_.set_corner_of(id, Topology2::kNone);
    std::erase(hidden_, id);
    return finish();
  }
  if (tiny()) {
    topology_.set_corner_of(id, Topology2::kNone);
    rebuild();
    return finish();
  }
  hull_touched_ = false;
  touched_.clear();
  const bool taken = remove_by_flips(id, sites_.data());
  topology_.set_corner_of(id, Topology2::kNone);
  if (taken && flip_to_regular({}, false)) {
    try_hidden();
  } else {
    ++report_.rebuilds;
    rebuild();
  }
  return finish();
}

void Triangulation<2>::begin() {
  report_ = {};
  edges_.begin_update();
#ifdef LAGRAIN_AUDIT
  edges_.remember();
#endif
}

UpdateReport Triangulation<2>::finish() {
  std::sort(hidden_.begin(), hidden_.end());
  edges_.end_update();
  expect_valid();
  return report_;
}

/// Nothing, unless lagrain was built to audit itself.
void Triangulation<2>::expect_valid() const {
#ifdef LAGRAIN_AUDIT
  if (const auto defects = audit(); !defects.empty()) {
    throw AuditError("Triangulation<2>: " + defects.front().sentence);
  }
#endif
}

}  // namespace lagrain
