// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `AnyNeighbourhood` holds a neighbourhood that was chosen at run time.

#include <lagrain/neighbourhood.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace lagrain {

/// Any neighbourhood behind one pointer. It is asked once per refresh of the near list, so the
/// virtual call costs nothing, and models need not be compiled once per neighbourhood.
template <int Dim>
class AnyNeighbourhood {
 public:
  /// Takes over a neighbourhood of any type.
  template <Neighbourhood<Dim> N>
  explicit AnyNeighbourhood(N neighbourhood)
      : held_(std::make_unique<Held<N>>(std::move(neighbourhood))) {}

  const char* name() const { return held_->name(); }  ///< for people
  /// What the held one answers, as Neighbourhood and AmendableNeighbourhood have it; pairs_of is
  /// false where it cannot amend.
  /// @{
  void near_pairs(const Columns<Dim>& x, const Eigen::VectorXd& radius, Eigen::VectorXd& margin,
                  std::vector<Pair>& pairs) {
    held_->near_pairs(x, radius, margin, pairs);
  }
  bool pairs_of(std::vector<int>& strays, const PlaceOf<Dim>& place, const Eigen::VectorXd& radius,
                Eigen::VectorXd& margin, std::vector<Pair>& pairs) {
    return held_->pairs_of(strays, place, radius, margin, pairs);
  }
  /// @}
  /// The grains have other numbers from now on.
  void forget() { held_->forget(); }
  /// Grains have left, and others have come behind those that stay.
  /// @param new_number  of each former grain, in the same order; -1: it has left
  void exchange(const std::vector<int>& new_number, const Columns<Dim>& x,
                const Eigen::VectorXd& radius) {
    held_->exchange(new_number, x, radius);
  }
  /// Whether it leaves out no pair.
  bool keeps_promise() const { return held_->keeps_promise(); }
  /// What the triangulation cost; null for other neighbourhoods.
  const TriangulationCost* cost() const { return held_->cost(); }
  /// Edges of the triangulation; 0 for other neighbourhoods.
  std::int64_t edges() const { return held_->edges(); }

 private:
  struct Interface {
    virtual ~Interface() = default;
    virtual const char* name() const = 0;
    virtual void near_pairs(const Columns<Dim>&, const Eigen::VectorXd&, Eigen::VectorXd&,
                            std::vector<Pair>&) = 0;
    virtual bool pairs_of(std::vector<int>&, const PlaceOf<Dim>&, const Eigen::VectorXd&,
                          Eigen::VectorXd&, std::vector<Pair>&) = 0;
    virtual void forget() = 0;
    virtual void exchange(const std::vector<int>&, const Columns<Dim>&, const Eigen::VectorXd&) = 0;
    virtual bool keeps_promise() const = 0;
    virtual const TriangulationCost* cost() const = 0;
    virtual std::int64_t edges() const = 0;
  };

  template <class N>
  struct Held final : Interface {
    explicit Held(N n) : neighbourhood(std::move(n)) {}
    const char* name() const override { return neighbourhood.name(); }
    void near_pairs(const Columns<Dim>& x, const Eigen::VectorXd& radius, Eigen::VectorXd& margin,
                    std::vector<Pair>& pairs) override {
      neighbourhood.near_pairs(x, radius, margin, pairs);
    }
    bool pairs_of(std::vector<int>& strays, const PlaceOf<Dim>& place,
                  const Eigen::VectorXd& radius, Eigen::VectorXd& margin,
                  std::vector<Pair>& pairs) override {
      if constexpr (AmendableNeighbourhood<N, Dim>) {
        return neighbourhood.pairs_of(strays, place, radius, margin, pairs);
      }
      return false;
    }
    void forget() override {
      if constexpr (requires { neighbourhood.forget(); }) neighbourhood.forget();
    }
    void exchange(const std::vector<int>& new_number, const Columns<Dim>& x,
                  const Eigen::VectorXd& radius) override {
      if constexpr (requires { neighbourhood.exchange(new_number, x, radius); }) {
        neighbourhood.exchange(new_number, x, radius);
      } else {
        forget();
      }
    }
    bool keeps_promise() const override { return lagrain::keeps_promise(neighbourhood); }
    const TriangulationCost* cost() const override {
      if constexpr (requires { neighbourhood.cost(); }) return &neighbourhood.cost();
      return nullptr;
    }
    std::int64_t edges() const override {
      std::int64_t count = 0;
      if constexpr (requires { neighbourhood.triangulation(); }) {
        neighbourhood.triangulation().for_each_edge([&](int, int) { ++count; });
      }
      return count;
    }
    N neighbourhood;
  };

  std::unique_ptr<Interface> held_;
};

}  // namespace lagrain
