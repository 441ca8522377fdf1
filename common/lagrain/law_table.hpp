#pragma once
/// @file
/// Which law acts between which kinds of grain and wall.

#include <lagrain/check.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lagrain {

/// Symmetric table of laws, one per pair of kinds. A scene of one kind has a table of one law, and
/// its grains store no kind.
template <class Law>
class LawTable {
 public:
  LawTable() = default;
  explicit LawTable(Law law, int kinds = 1)
      : kinds_(static_cast<std::size_t>(kinds)), laws_(kinds_ * kinds_, law) {
    LAGRAIN_EXPECTS(kinds >= 1 && kinds <= 255, "kinds " + std::to_string(kinds));
  }

  void set(int a, int b, const Law& law) {
    laws_[index(static_cast<std::size_t>(a), static_cast<std::size_t>(b))] = law;
    laws_[index(static_cast<std::size_t>(b), static_cast<std::size_t>(a))] = law;
  }
  const Law& between(std::size_t a, std::size_t b) const { return laws_[index(a, b)]; }
  int kinds() const { return static_cast<int>(kinds_); }

  /// The law between two grains, or between a grain and a wall of the given kind.
  const Law& of(const std::vector<std::uint8_t>& kind, int i, int j) const {
    if (kind.empty()) return laws_.front();
    return between(kind[static_cast<std::size_t>(i)], kind[static_cast<std::size_t>(j)]);
  }
  const Law& with_wall(const std::vector<std::uint8_t>& kind, int i, int wall_kind) const {
    return between(kind.empty() ? 0 : kind[static_cast<std::size_t>(i)],
                   static_cast<std::size_t>(wall_kind));
  }

 private:
  std::size_t index(std::size_t a, std::size_t b) const { return a * kinds_ + b; }

  std::size_t kinds_ = 0;
  std::vector<Law> laws_;
};

}  // namespace lagrain
