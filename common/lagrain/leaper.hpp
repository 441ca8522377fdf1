// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `Leaper` builds the regular triangulation T anew, with wide skins, where many grains fly, and
/// leaves it as it is.

#include <lagrain/lazy_sites.hpp>
#include <lagrain/reach_list.hpp>
#include <lagrain/update_prices.hpp>
#include <lagrain/vec.hpp>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace lagrain {

/// Where many grains fly, or a few very far, single moves cost more than to build T anew, and wider
/// skins make both rarer. They leave the certificate behind. So T *leaps*: it is built with wide
/// skins, and the pairs of reference balls that meet are listed by walking in it, which asks for no
/// certificate (ReachList). Until the next leap T stays as it is; grains that leave their wide
/// skins find their partners by such walks as well.
template <int Dim, RegularTriangulation<Dim> T>
class Leaper {
 public:
  using Sites = LazySites<Dim, T>;  ///< what it works on

  /// Builds T anew with references where the grains are, and lists the pairs that meet.
  /// @pre T knows the grains
  void leap(Sites& sites, const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    Eigen::VectorXd smallest = radius;  // around a grain, which a wider skin would hide
    for (const auto& [i, j] : sites.t.edges()) {
      smallest[i] = std::min(smallest[i], radius[j]);
      smallest[j] = std::min(smallest[j], radius[i]);
    }
    sites.drift.setZero();
    for (int i = 0; i < sites.size(); ++i) {
      const double skin = kWideSkin * smallest[i];
      sites.reference.col(i) = x.col(i) + skin * sites.aside.col(i);
      sites.set_skin(radius, i, kUsable * skin);
    }
    sites.t.build(sites.reference, sites.weight);
    reach_.build(sites.t, [&](int i) { return reference_ball(sites, radius, i); });
    ++sites.cost.leaps;
  }

  /// Gives new references to the grains that wait; they walk.
  /// @returns what that cost [ns], roughly
  template <class Place>
  std::int64_t update(Sites& sites, Place&& place, const Eigen::VectorXd& radius) {
    sites.placed.swap(sites.waiting);
    for (const int i : sites.placed) {
      sites.reference.col(i) = place(i) - sites.drift;
      reach_.move(i, reference_ball(sites, radius, i));
      sites.standing_of(i) = Sites::Standing::at_rest;
    }
    const auto walks = static_cast<std::int64_t>(sites.placed.size());
    sites.cost.walks += walks;
    return walks *
           (Prices::kWalk + Prices::kComparison * static_cast<std::int64_t>(reach_.apart()));
  }

  /// The pairs of reference balls that meet.
  const ReachList<Dim>& reach() const { return reach_; }
  /// T follows from now on.
  void forget() { reach_ = {}; }

  /// The balls that walks know are those of the sites, and all that meet are listed.
  void audit(const Sites& sites, const Eigen::VectorXd& radius,
             std::vector<std::string>& defects) const {
    for (const std::string& defect : reach_.audit(sites.t)) defects.push_back("walks: " + defect);
    for (int i = 0; i < sites.size(); ++i) {
      const auto ball = reference_ball(sites, radius, i);
      if (reach_.ball(i).centre == ball.centre && reach_.ball(i).radius == ball.radius) continue;
      defects.push_back("the reference of grain " + std::to_string(i) + " is not sound");
    }
  }

 private:
  friend struct AuditProbe;
  using Prices = UpdatePrices<Dim>;

  /// Width of the skins, of the smallest radius around. It was chosen on the shaken beds of
  /// `bench_lagrain`, where 1.5 in both dimensions was slower: discs want more, spheres less. It
  /// changes no result. Skins of half the width are left more often, those of twice the width meet
  /// more partners.
  static constexpr double kWideSkin = Dim == 2 ? 2.0 : 1.0;

  static typename ReachList<Dim>::Ball reference_ball(const Sites& sites,
                                                      const Eigen::VectorXd& radius, int i) {
    return {sites.reference.col(i), radius[i] + sites.skin[i]};
  }

  ReachList<Dim> reach_;
};

}  // namespace lagrain
