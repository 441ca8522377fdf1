#include <lagrain/triangulation3.hpp>

#include <lagrain/check.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace lagrain {

namespace {

void expect_finite(const Site3& s, int id) {
  LAGRAIN_EXPECTS(
      std::isfinite(s.x) && std::isfinite(s.y) && std::isfinite(s.z) && std::isfinite(s.w),
      "site " + std::to_string(id) + " is not finite: (" + std::to_string(s.x) + ", " +
          std::to_string(s.y) + ", " + std::to_string(s.z) + ") with weight " +
          std::to_string(s.w));
}

void expect_same_size(Eigen::Index columns, Eigen::Index weights) {
  LAGRAIN_EXPECTS(columns == weights,
                  std::to_string(columns) + " sites with " + std::to_string(weights) + " weights");
}

Site3 site_of(const Columns<3>& sites, const Eigen::VectorXd& weights, int id) {
  return {sites(0, id), sites(1, id), sites(2, id), weights[id]};
}

}  // namespace

// corner_of(site) when it is not visible: kNone if not present, -2 - hint if hidden.
bool Triangulation<3>::contains(int id) const {
  return id >= 0 && id < size_ && topology_.corner_of(id) != Topology3::kNone;
}

void Triangulation<3>::build(const Columns<3>& sites, const Eigen::VectorXd& weights) {
  expect_same_size(sites.cols(), weights.size());
  const auto n = static_cast<int>(sites.cols());
  for (int i = 0; i < n; ++i) expect_finite(site_of(sites, weights, i), i);
  size_ = present_ = n;
  sites_.resize(index(n) + 3);
  site_note_.assign(index(n) + 3, 0);
  for (int i = 0; i < n; ++i) sites_[index(i)] = site_of(sites, weights, i);
  topology_.clear(n + 3);
  // A note that says "present"; rebuild() replaces it.
  for (int i = 0; i < n; ++i) topology_.set_corner_of(i, -2);
  rebuild();
  before_ = sites_;
  expect_valid();
}

UpdateReport Triangulation<3>::move(std::span<const int> moved, const Columns<3>& sites,
                                    const Eigen::VectorXd& weights) {
  expect_same_size(sites.cols(), weights.size());
  LAGRAIN_EXPECTS(sites.cols() == size_,
                  std::to_string(sites.cols()) + " columns for " + std::to_string(size_) + " ids");
  for (const int id : moved) {
    LAGRAIN_EXPECTS(contains(id), "site " + std::to_string(id) + " is not present");
    expect_finite(site_of(sites, weights, id), id);
  }
  begin();
  moved_.clear();
  for (const int id : moved) {
    const Site3 place = site_of(sites, weights, id);
    if (place == sites_[index(id)]) continue;  // also drops repetitions
    sites_[index(id)] = place;
    moved_.push_back(id);
  }
  if (moved_.empty()) return finish();
  if (tiny()) {
    rebuild();
  } else {
    collect_around(moved_);
    if (extract_inverted() && flip_to_regular()) {
      try_hidden();
    } else {
      ++report_.rebuilds;
      rebuild();
    }
  }
  for (const int id : moved_) before_[index(id)] = sites_[index(id)];
  return finish();
}

UpdateReport Triangulation<3>::insert(int id, const Vec<3>& position, double weight) {
  LAGRAIN_EXPECTS(id >= 0 && id <= size_ && !contains(id),
                  "cannot insert site " + std::to_string(id) + ", size " + std::to_string(size_));
  const Site3 place{position[0], position[1], position[2], weight};
  expect_finite(place, id);
  begin();
  if (id == size_) {
    if (size_ == 0) topology_.clear(3);
    ++size_;
    // Auxiliary sites have the ids above; a set that has some is built anew in any case.
    sites_.resize(index(size_) + 3);
    before_.resize(index(size_) + 3);
    site_note_.resize(index(size_) + 3, 0);
    topology_.add_vertex();
  }
  sites_[index(id)] = before_[index(id)] = place;
  topology_.set_corner_of(id, -2 - last_);
  ++present_;
  if (tiny()) {
    rebuild();
  } else if (!insert_visible(id)) {
    hidden_.push_back(id);
  }
  return finish();
}

UpdateReport Triangulation<3>::remove(int id) {
  LAGRAIN_EXPECTS(contains(id), "site " + std::to_string(id) + " is not present");
  begin();
  --present_;
  if (topology_.corner_of(id) <= -2) {
    topology_.set_corner_of(id, Topology3::kNone);
    std::erase(hidden_, id);
    return finish();
  }
  touched_.clear();
  hull_touched_ = false;
  const bool taken = !tiny() && take_out(id);
  topology_.set_corner_of(id, Topology3::kNone);
  if (taken) {
    if (hull_touched_) choose_middle_at_rest();
    try_hidden();
  } else {
    // Below kTiny a build is the ordinary way.
    report_.rebuilds += tiny() ? 0 : 1;
    rebuild();
  }
  return finish();
}

void Triangulation<3>::begin() {
  report_ = {};
  edges_.begin_update();
#ifdef LAGRAIN_AUDIT
  edges_.remember();
#endif
}

UpdateReport Triangulation<3>::finish() {
  std::sort(hidden_.begin(), hidden_.end());
  edges_.end_update();
  expect_valid();
  return report_;
}

/// Nothing, unless lagrain was built to audit itself.
void Triangulation<3>::expect_valid() const {
#ifdef LAGRAIN_AUDIT
  if (const auto defects = audit(); !defects.empty()) {
    throw AuditError("Triangulation<3>: " + defects.front().sentence);
  }
#endif
}

}  // namespace lagrain
