// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `LazySites` holds the regular triangulation T with a reference place and a skin for each grain:
/// T need not change while the grains stay within their skins.

#include <lagrain/random.hpp>
#include <lagrain/skins.hpp>
#include <lagrain/triangulation.hpp>
#include <lagrain/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lagrain {

/// How the triangulation follows the grains. The defaults are proved to miss nothing; other values
/// exist to show and to test what goes wrong without them.
struct Laziness {
  /// Skins as multiples of those that pass the certificate although references are taken at
  /// different instants: 0.2426 r between two equal grains that touch, more where there is room.
  double skin = 1.3;
  bool certify = true;  ///< test the certificate after every update
  bool follow = true;   ///< false: T is built once and never moved
  bool leap = true;     ///< where many grains fly, build T anew with wide skins
};

/// What the triangulation has cost so far.
struct TriangulationCost {
  std::int64_t updates = 0;   ///< refreshes in which some reference centre moved
  std::int64_t moved = 0;     ///< reference centres moved
  UpdateReport ladder;        ///< what the updates had to do
  std::int64_t shrunk = 0;    ///< grains given a small skin because an edge failed the certificate
  std::int64_t searched = 0;  ///< range searches around grains that still failed, or are hidden
  std::int64_t leaps = 0;     ///< builds with wide skins
  std::int64_t walks = 0;     ///< grains that left wide skins
};

/// T, and for each grain its reference, its skin and where it stands in an update (skins.hpp has
/// the symbols). References are in a frame that drifts with the grains, because T does not change
/// when everything moves together.
template <int Dim, RegularTriangulation<Dim> T>
struct LazySites {
  /// Where a grain stands in an update: not concerned, in `waiting`, or given its new reference.
  enum class Standing : unsigned char { at_rest, waiting, placed };

  T t;                                ///< regular for the references and weights
  Columns<Dim> reference;             ///< c_i [m]
  Eigen::VectorXd skin;               ///< s_i [m]
  Eigen::VectorXd weight;             ///< w_i [m^2]
  Vec<Dim> drift = Vec<Dim>::Zero();  ///< of the grains against the references' frame [m]
  std::vector<Standing> standing;     ///< of each grain
  std::vector<int> waiting;           ///< grains that need new references
  std::vector<int> placed;            ///< grains that got them in this update; maybe twice
  TriangulationCost cost;             ///< since the start
  /// References stand aside by this times the skin, each in a direction of its own: so they are in
  /// general position even where grains lie on a lattice, and predicates need no exact arithmetic.
  Columns<Dim> aside;

  int size() const { return static_cast<int>(weight.size()); }  ///< number of grains
  /// Where grain i stands.
  Standing& standing_of(int i) { return standing[static_cast<std::size_t>(i)]; }

  /// Forgets all grains and begins with these, of which none waits.
  void reset(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    Random random(1);
    aside = x.unaryExpr([&](double) { return kHair * random.uniform(-1, 1); });
    skin.setZero(radius.size());
    standing.assign(static_cast<std::size_t>(x.cols()), Standing::at_rest);
    waiting.clear();
    placed.clear();
  }

  /// Builds T for the grains as they are.
  void build_without_skins(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    reference = x;
    for (int i = 0; i < x.cols(); ++i) reference.col(i) += radius[i] * aside.col(i);
    drift.setZero();
    weight = radius.array().square();
    t.build(reference, weight);
  }

  /// Grains leave T, and others join it with small skins. Edges are not tested.
  /// @param new_number  of each former grain, in the same order; -1: it has left
  /// @param x           all grains now, those that have come behind the others
  void exchange(const std::vector<int>& new_number, const Columns<Dim>& x,
                const Eigen::VectorXd& radius) {
    int stay = 0;
    for (int i = 0; i < size(); ++i) {
      const int k = new_number[static_cast<std::size_t>(i)];
      if (k < 0) {
        cost.ladder += t.remove(i);
        continue;
      }
      reference.col(k) = reference.col(i);
      aside.col(k) = aside.col(i);
      skin[k] = skin[i];
      weight[k] = weight[i];
      ++stay;
    }
    t.close_gaps();
    reference.conservativeResize(Dim, x.cols());
    aside.conservativeResize(Dim, x.cols());
    skin.conservativeResize(x.cols());
    weight.conservativeResize(x.cols());
    standing.assign(static_cast<std::size_t>(x.cols()), Standing::at_rest);
    Random random(static_cast<std::uint64_t>(x.cols()));
    for (int i = stay; i < size(); ++i) {
      for (int d = 0; d < Dim; ++d) aside(d, i) = kHair * random.uniform(-1, 1);
      const double s = kSmallSkin * radius[i];
      reference.col(i) = x.col(i) - drift + s * aside.col(i);
      set_skin(radius, i, kUsable * s);
      cost.ladder += t.insert(i, reference.col(i), weight[i]);
    }
  }

  /// Gives a grain another skin [m], and so another weight.
  void set_skin(const Eigen::VectorXd& radius, int i, double s) {
    skin[i] = s;
    weight[i] = weight_with(radius[i], s);
  }

  /// How far a grain at x may move before it leaves its skin [m]; negative if it has, or is not
  /// a number.
  double room(int i, const Vec<Dim>& x) const {
    return skin[i] * kUsable - (x - drift - reference.col(i)).norm();
  }

  /// Lets a grain wait for a new reference.
  void join(int i) {
    standing_of(i) = Standing::waiting;
    waiting.push_back(i);
  }

  /// Whether the reference balls of two grains pass the certificate.
  bool pass(int a, int b) const {
    return passes_certificate((reference.col(a) - reference.col(b)).squaredNorm(), weight[a],
                              weight[b]);
  }

  /// The least radius among a grain and its neighbours in T.
  double smallest_around(const Eigen::VectorXd& radius, int i) const {
    double smallest = radius[i];
    t.for_each_neighbour(i, [&](int j) { smallest = std::min(smallest, radius[j]); });
    return smallest;
  }

 private:
  /// Of a skin. Ten times more or less serves as well: it only must be far above rounding and far
  /// below what makes a skin useful.
  static constexpr double kHair = 1e-7;
};

}  // namespace lagrain
