// SPDX-License-Identifier: GPL-3.0-or-later
#include "predicate_trials.hpp"

#include "dense_packing.hpp"
#include "exact_sign.hpp"

#include <lagrain/check.hpp>
#include <lagrain/random.hpp>
#include <lagrain/vec.hpp>

#include <CGAL/Interval_nt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lagrain::figures {

template <class Predicate>
int always_exact_sign(const Query<Predicate>& query) {
  return static_cast<int>(CGAL::sign(std::apply(
      [](const auto&... sites) { return Predicate::template of<detail::ExactNumber>(sites...); },
      query)));
}

template <class Predicate>
bool intervals_decide(const Query<Predicate>& query) {
  const CGAL::Interval_nt_advanced::Protector round_upwards;
  return CGAL::is_certain(CGAL::sign(std::apply(
      [](const auto&... sites) {
        return Predicate::template of<CGAL::Interval_nt_advanced>(sites...);
      },
      query)));
}

template <class Predicate>
Tally tally(std::span<const Query<Predicate>> queries) {
  Tally t;
  for (const auto& query : queries) {
    const int exact = always_exact_sign<Predicate>(query), plain = plain_sign<Predicate>(query);
    ++t.queries;
    t.wrong += plain != exact;
    t.opposite += plain * exact < 0;
    t.ties += exact == 0;
    t.undecided += !intervals_decide<Predicate>(query);
  }
  return t;
}

namespace {

template <int Dim>
Vec<Dim> place_of(const Site<Dim>& site) {
  if constexpr (Dim == 2) {
    return {site.x, site.y};
  } else {
    return {site.x, site.y, site.z};
  }
}

template <int Dim>
Site<Dim> site_at(const Vec<Dim>& x, double weight) {
  if constexpr (Dim == 2) {
    return {x[0], x[1], weight};
  } else {
    return {x[0], x[1], x[2], weight};
  }
}

template <int Dim>
Vec<Dim> uniform_place(Random& random, double side) {
  Vec<Dim> x;
  for (double& coordinate : x) coordinate = random.uniform(0, side);
  return x;
}

/// Equal grains of weight 1/4 and spacing about 1 at places that a function makes up.
template <int Dim, class F>
TrialSet<Dim> equal_grains(const std::string& name, int count, F&& place) {
  TrialSet<Dim> set{name, {}};
  for (int i = 0; i < count; ++i) set.sites.push_back(site_at<Dim>(place(i), 0.25));
  return set;
}

template <int Dim>
TrialSet<Dim> at_random(int count, Random& random) {
  TrialSet<Dim> set{"random", {}};
  const double side = std::pow(count, 1.0 / Dim);
  for (int i = 0; i < count; ++i) {
    const double r = random.uniform(0.35, 0.5);
    set.sites.push_back(site_at<Dim>(uniform_place<Dim>(random, side), r * r));
  }
  return set;
}

template <int Dim>
TrialSet<Dim> packing(int count) {
  TrialSet<Dim> set{"packing", {}};
  for (const Grain<Dim>& grain : dense_packing<Dim>(count, 1)) {
    set.sites.push_back(site_at<Dim>(grain.position, grain.radius * grain.radius));
  }
  return set;
}

/// A set so far from the origin that its coordinates lose 20 of their bits.
template <int Dim>
TrialSet<Dim> far_away(const TrialSet<Dim>& near) {
  TrialSet<Dim> set{near.name + ", far away", {}};
  for (const Site<Dim>& site : near.sites) {
    set.sites.push_back(site_at<Dim>(place_of<Dim>(site) + Vec<Dim>::Constant(1e6), site.w));
  }
  return set;
}

constexpr double kPitch = 0.1;  // of lattices [m]: no double

/// @param place  of the node with the given integer coordinates [pitch]
template <int Dim, class F>
TrialSet<Dim> lattice(const std::string& name, int count, F&& place) {
  const int side = static_cast<int>(std::lround(std::pow(count, 1.0 / Dim)));
  TrialSet<Dim> set{name, {}};
  for (int k = 0; k < (Dim == 2 ? 1 : side); ++k) {
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        set.sites.push_back(site_at<Dim>(kPitch * place(i, j, k), kPitch * kPitch / 4));
      }
    }
  }
  return set;
}

/// A lattice with every coordinate off by up to 10^-6 of the pitch.
template <int Dim>
TrialSet<Dim> disturbed(const TrialSet<Dim>& exact, Random& random) {
  constexpr double kMost = 1e-6 * kPitch;
  TrialSet<Dim> set{exact.name + " off by 1e-6", {}};
  for (const Site<Dim>& site : exact.sites) {
    Vec<Dim> x = place_of<Dim>(site);
    for (double& coordinate : x) coordinate += random.uniform(-kMost, kMost);
    set.sites.push_back(site_at<Dim>(x, site.w));
  }
  return set;
}

}  // namespace

template <>
std::vector<TrialSet<2>> trial_sets<2>(int count) {
  Random random(2);
  std::vector<TrialSet<2>> sets{at_random<2>(count, random), packing<2>(count)};
  sets.push_back(far_away(sets.back()));
  sets.push_back(
      lattice<2>("square lattice", count, [](int i, int j, int) { return Vec<2>(i, j); }));
  sets.push_back(disturbed(sets.back(), random));
  sets.push_back(lattice<2>("hexagonal lattice", count, [](int i, int j, int) {
    return Vec<2>(i + 0.5 * (j % 2), j * std::sqrt(0.75));
  }));
  const double radius = count / (2 * std::numbers::pi);
  sets.push_back(equal_grains<2>("on a circle", count, [&](int) {
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    return Vec<2>(radius * std::cos(angle), radius * std::sin(angle));
  }));
  // As if both coordinates had been computed, and only their last two bits were rounded otherwise.
  sets.push_back(equal_grains<2>("near a line", count, [&](int) {
    const double along = random.uniform(0, count);
    return Vec<2>(along * (1 + random.below(4) * 0x1p-52), along * (1 + random.below(4) * 0x1p-52));
  }));
  return sets;
}

template <>
std::vector<TrialSet<3>> trial_sets<3>(int count) {
  Random random(3);
  std::vector<TrialSet<3>> sets{at_random<3>(count, random), packing<3>(count)};
  sets.push_back(far_away(sets.back()));
  sets.push_back(
      lattice<3>("cubic lattice", count, [](int i, int j, int k) { return Vec<3>(i, j, k); }));
  sets.push_back(disturbed(sets.back(), random));
  sets.push_back(lattice<3>("face-centred cubic", count,
                            [](int i, int j, int k) { return Vec<3>(j + k, i + k, i + j); }));
  const double radius = std::sqrt(count / (4 * std::numbers::pi));
  sets.push_back(equal_grains<3>("on a sphere", count, [&](int) {
    Vec<3> direction;
    for (double& component : direction) component = random.normal();
    return Vec<3>(radius * direction.normalized());
  }));
  const Vec<3> u = Vec<3>(1, std::sqrt(2.0), -0.3).normalized();
  const Vec<3> v = Vec<3>(std::sqrt(2.0), -1, 0).normalized();
  sets.push_back(equal_grains<3>("near a plane", count, [&](int) {
    const Vec<2> x = uniform_place<2>(random, std::sqrt(count));
    return Vec<3>(x[0] * u + x[1] * v);
  }));
  return sets;
}

template <class Predicate>
std::vector<Query<Predicate>> draw_queries(const std::vector<Site<Predicate::kDim>>& sites,
                                           int count, std::uint64_t seed) {
  constexpr int kDim = Predicate::kDim;
  constexpr std::size_t kNearest = kDim == 2 ? 9 : 19;  // two shells of a lattice, and the site
  constexpr int kTries = 100;                           // for one query
  LAGRAIN_EXPECTS(sites.size() >= kNearest, "too few sites to draw queries from");
  Random random(seed);
  std::vector<std::pair<double, std::size_t>> nearest(sites.size());
  std::vector<Query<Predicate>> queries;
  for (int tries = 0; static_cast<int>(queries.size()) < count; ++tries) {
    LAGRAIN_EXPECTS(tries < kTries * count, "hardly any query with a positive simplex");
    const Vec<kDim> centre = place_of<kDim>(
        sites[static_cast<std::size_t>(random.below(static_cast<int>(sites.size())))]);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      nearest[i] = {(place_of<kDim>(sites[i]) - centre).squaredNorm(), i};
    }
    std::partial_sort(nearest.begin(), nearest.begin() + kNearest, nearest.end());
    // The site itself is first; others are drawn after it, and then all are shuffled.
    Query<Predicate> query;
    for (std::size_t k = 0; k < query.size(); ++k) {
      const auto left = static_cast<int>(kNearest - k);
      const std::size_t drawn = k == 0 ? 0 : k + static_cast<std::size_t>(random.below(left));
      std::swap(nearest[k], nearest[drawn]);
      query[k] = sites[nearest[k].second];
    }
    for (std::size_t k = query.size() - 1; k > 0; --k) {
      std::swap(query[k], query[static_cast<std::size_t>(random.below(static_cast<int>(k) + 1))]);
    }
    if constexpr (Predicate::kSites == kDim + 2) {
      Query<Orientation<kDim>> simplex;
      std::copy_n(query.begin(), simplex.size(), simplex.begin());
      const int turn = filtered_sign<Orientation<kDim>>(simplex);
      if (turn == 0) continue;
      if (turn < 0) std::swap(query[0], query[1]);
    }
    queries.push_back(query);
  }
  return queries;
}

OrientationMap orientation_map(int side) {
  OrientationMap map{side, {}, {}};
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const Site2 p{0.5 + column * 0x1p-53, 0.5 + row * 0x1p-53, 0};
      // In this order the differences are taken relative to p, as in the paper.
      const Query<Orientation<2>> query{Site2{12, 12, 0}, Site2{24, 24, 0}, p};
      map.plain.push_back(plain_sign<Orientation<2>>(query));
      map.exact.push_back(filtered_sign<Orientation<2>>(query));
    }
  }
  return map;
}

template int always_exact_sign<Orientation<2>>(const Query<Orientation<2>>&);
template int always_exact_sign<Orientation<3>>(const Query<Orientation<3>>&);
template int always_exact_sign<PowerSide<2>>(const Query<PowerSide<2>>&);
template int always_exact_sign<PowerSide<3>>(const Query<PowerSide<3>>&);
template bool intervals_decide<Orientation<2>>(const Query<Orientation<2>>&);
template bool intervals_decide<Orientation<3>>(const Query<Orientation<3>>&);
template bool intervals_decide<PowerSide<2>>(const Query<PowerSide<2>>&);
template bool intervals_decide<PowerSide<3>>(const Query<PowerSide<3>>&);
template Tally tally<Orientation<2>>(std::span<const Query<Orientation<2>>>);
template Tally tally<Orientation<3>>(std::span<const Query<Orientation<3>>>);
template Tally tally<PowerSide<2>>(std::span<const Query<PowerSide<2>>>);
template Tally tally<PowerSide<3>>(std::span<const Query<PowerSide<3>>>);
template std::vector<Query<Orientation<2>>> draw_queries<Orientation<2>>(const std::vector<Site2>&,
                                                                         int, std::uint64_t);
template std::vector<Query<Orientation<3>>> draw_queries<Orientation<3>>(const std::vector<Site3>&,
                                                                         int, std::uint64_t);
template std::vector<Query<PowerSide<2>>> draw_queries<PowerSide<2>>(const std::vector<Site2>&, int,
                                                                     std::uint64_t);
template std::vector<Query<PowerSide<3>>> draw_queries<PowerSide<3>>(const std::vector<Site3>&, int,
                                                                     std::uint64_t);

}  // namespace lagrain::figures
