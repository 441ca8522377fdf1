// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Neighbourhoods that exist to be compared with: an oracle that is handed the contacts, and a
/// triangulation that is built anew at every refresh.

#include <lagrain/neighbourhood.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace lagrain::bench {

/// What a neighbourhood has answered in the course of a run: for every call the margins it granted,
/// and of the pairs it gave those that touched before the next call.
template <int Dim>
struct Answers {
  struct Call {
    Columns<Dim> x;  ///< dropped once the slots are known
    Eigen::VectorXd margin;
    std::vector<Pair> pairs;
    std::vector<bool> touched;
    std::vector<int> id;  ///< of the grain in each slot; empty while unknown
  };
  std::vector<Call> calls;
};

/// The triangulation, with its answers written down.
template <int Dim>
class RecordingNeighbourhood {
 public:
  RecordingNeighbourhood() : answers_(std::make_shared<Answers<Dim>>()) {}

  static const char* name() { return "recorded triangulation"; }

  void near_pairs(const Columns<Dim>& x, const Eigen::VectorXd& radius, Eigen::VectorXd& margin,
                  std::vector<Pair>& pairs) {
    inner_.near_pairs(x, radius, margin, pairs);
    answers_->calls.push_back({x, margin, pairs, std::vector<bool>(pairs.size(), false), {}});
  }
  const std::shared_ptr<Answers<Dim>>& answers() const { return answers_; }

 private:
  TriangulationNeighbourhood<Dim> inner_;
  std::shared_ptr<Answers<Dim>> answers_;
};

/// Numbers 0 to n - 1 in the order of the places of their grains.
template <int Dim>
std::vector<int> order_of_places(const Columns<Dim>& x) {
  std::vector<int> order(static_cast<std::size_t>(x.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::lexicographical_compare(x.col(a).begin(), x.col(a).end(), x.col(b).begin(),
                                        x.col(b).end());
  });
  return order;
}

/// Notes which pairs of the last answer touch now. To be called after the simulation was made and
/// after every step. A neighbourhood sees the grains in slots, the observer by id: they are matched
/// by their places, which do not change between the last call of a step and its end.
template <int Dim>
void note_touching(Answers<Dim>& answers, const Columns<Dim>& x, const Eigen::VectorXd& radius) {
  auto& call = answers.calls.back();
  if (call.id.empty()) {
    const std::vector<int> slots = order_of_places<Dim>(call.x), ids = order_of_places<Dim>(x);
    call.id.resize(slots.size());
    for (std::size_t k = 0; k < slots.size(); ++k) {
      const bool same = call.x.col(slots[k]) == x.col(ids[k]);
      LAGRAIN_EXPECTS(same, "a grain has moved since its neighbourhood was asked");
      call.id[static_cast<std::size_t>(slots[k])] = ids[k];
    }
    call.x.resize(Dim, 0);
  }
  for (std::size_t k = 0; k < call.pairs.size(); ++k) {
    if (call.touched[k]) continue;
    const int i = call.id[static_cast<std::size_t>(call.pairs[k].i)];
    const int j = call.id[static_cast<std::size_t>(call.pairs[k].j)];
    const double reach = radius[i] + radius[j];
    // A hair more than touching, so that rounding cannot leave a contact out.
    call.touched[k] = (x.col(i) - x.col(j)).squaredNorm() < reach * reach * (1 + 1e-12);
  }
}

/// Knows what will touch, for nothing: repeats the answers of an earlier run from the same state,
/// reduced to the pairs that touch before the next question. A lower bound for any neighbourhood.
template <int Dim>
class Oracle {
 public:
  /// @param answers of a run that was observed with note_touching
  explicit Oracle(const Answers<Dim>& answers) : calls_(std::make_shared<std::vector<Reply>>()) {
    for (const auto& call : answers.calls) {
      Reply reply{{}, call.margin};
      for (std::size_t k = 0; k < call.pairs.size(); ++k) {
        if (call.touched[k]) reply.pairs.push_back(call.pairs[k]);
      }
      calls_->push_back(std::move(reply));
    }
  }

  static const char* name() { return "oracle"; }
  /// The oracle knows the contacts, not all pairs within reach.
  static bool keeps_promise() { return false; }

  /// @throws ContractError beyond the end of the recorded run
  void near_pairs(const Columns<Dim>&, const Eigen::VectorXd&, Eigen::VectorXd& margin,
                  std::vector<Pair>& pairs) {
    LAGRAIN_EXPECTS(next_ < calls_->size(), "the oracle knows no more than the run it was made of");
    const Reply& reply = (*calls_)[next_++];
    margin = reply.margin;
    pairs = reply.pairs;
  }

 private:
  struct Reply {
    std::vector<Pair> pairs;
    Eigen::VectorXd margin;
  };
  std::shared_ptr<std::vector<Reply>> calls_;  // shared: copies of the oracle start where it is
  std::size_t next_ = 0;
};

/// A regular triangulation that does not follow the grains but is built from nothing whenever it is
/// asked. All grains have the same skin, small enough that the certificate of the lazy one holds
/// without a test as long as overlaps are not deep.
template <int Dim, RegularTriangulation<Dim> T = Triangulation<Dim>>
class RebuiltTriangulation {
 public:
  static const char* name() { return "triangulation built anew"; }

  void near_pairs(const Columns<Dim>& x, const Eigen::VectorXd& radius, Eigen::VectorXd& margin,
                  std::vector<Pair>& pairs) {
    const double skin = kSkin * radius.minCoeff();
    margin = margin.cwiseMin(skin);
    t_.build(x, (radius.array() + skin).square().matrix());
    pairs.clear();
    t_.for_each_edge([&](int a, int b) {
      const int i = std::min(a, b), j = std::max(a, b);
      if (within_reach<Dim>(x, radius, margin, i, j)) pairs.push_back({i, j});
    });
    sort_pairs(pairs, t_.size());
  }

 private:
  static constexpr double kSkin = 0.12;  // of the smallest radius

  T t_;
};

}  // namespace lagrain::bench
