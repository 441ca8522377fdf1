// SPDX-License-Identifier: GPL-3.0-or-later
#include "speed.hpp"

#include "measure.hpp"

#include <algorithm>
#include <cstddef>

namespace lagrain::bench {

double Contender::median() const { return median_of(ns); }

double Contender::spread() const {
  const auto [low, high] = std::minmax_element(ns.begin(), ns.end());
  return ns.empty() ? kUnknown : (*high - *low) / median();
}

double ratio(const Contender& a, const Contender& b) {
  std::vector<double> ratios;
  for (std::size_t round = 0; round < std::min(a.ns.size(), b.ns.size()); ++round) {
    ratios.push_back(a.ns[round] / b.ns[round]);
  }
  return ratios.empty() ? kUnknown : median_of(ratios);
}

const Contender* SceneSpeed::find(const std::string& wanted) const {
  for (const Contender& contender : contenders) {
    if (contender.name == wanted) return &contender;
  }
  return nullptr;
}

}  // namespace lagrain::bench
