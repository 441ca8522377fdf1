// SPDX-License-Identifier: GPL-3.0-or-later
// Prints hashes of what triangulations, cells, signs and scenes come to. It is compiled for this
// machine and for browsers, and both must print the same (check_same.cmake): exact arithmetic is
// exact without directed rounding, and trajectories are the same bits.
//
// usage: same [seeds]     12 sets in the plane for each seed, and 8 in space for each fourth one

#include <lagrain/laguerre2.hpp>
#include <lagrain/predicates2.hpp>
#include <lagrain/restitution.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>

#include "dim2/sets2.hpp"
#include "dim3/sets3.hpp"
#include "teach/lab.hpp"

#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace lagrain {
namespace {

/// FNV-1a over the bytes of numbers.
class Hash {
 public:
  void add(std::uint64_t bits) {
    for (int k = 0; k < 64; k += 8) {
      value_ ^= bits >> k & 0xff;
      value_ *= 1099511628211U;
    }
  }
  void add(int number) { add(static_cast<std::uint64_t>(number)); }
  void add(double number) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    add(bits);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037U;
};

auto simplices(const Triangulation<2>& t) { return test::triangles(t); }
auto simplices(const Triangulation<3>& t) { return test::tetrahedra(t); }

template <int Dim>
void add(Hash& hash, const Triangulation<Dim>& t) {
  for (const auto& corners : simplices(t)) {
    for (const int i : corners) hash.add(i);
  }
  hash.add(-1);
  t.for_each_edge([&](int i, int j) {
    hash.add(i);
    hash.add(j);
  });
  hash.add(-2);
  for (const int i : t.hidden()) hash.add(i);
}

struct Totals {
  int sets = 0;
  int updates = 0;
  int defects = 0;
};

/// Moves, takes out and inserts sites of a set, and hashes T after each update.
template <int Dim>
void try_set(test::SiteSet<Dim> s, Random& random, Totals& totals) {
  ++totals.sets;
  Hash given, come;
  for (const double number : s.x.reshaped()) given.add(number);
  for (const double number : s.w) given.add(number);
  Triangulation<Dim> t;
  t.build(s.x, s.w);
  add(come, t);
  const auto note = [&](const UpdateReport&) {
    ++totals.updates;
    add(come, t);
  };

  // Lattices move by eighths, so that they stay full of ties.
  const bool tied = s.name.find("lattice") != std::string::npos || s.name == "integers";
  for (const double distance : {0.01, 0.17, 0.5, 1.0}) {
    for (const double fraction : {0.0, 0.1, 1.0}) {
      auto moved = test::some_ids(random, s.size(), fraction);
      if (moved.empty()) moved = {random.below(s.size())};
      for (const int i : moved) {
        for (int axis = 0; axis < Dim; ++axis) {
          s.x(axis, i) += tied ? 0.125 * random.below(3) : s.r * distance * random.uniform(-1, 1);
        }
        if (random.uniform() < 0.3) s.w[i] *= 0.5;
      }
      note(t.move(moved, s.x, s.w));
    }
  }
  for (int k = 0; k < 10; ++k) {
    const int i = random.below(s.size());
    if (t.contains(i)) note(t.remove(i));
  }
  for (int i = 0; i < s.size(); ++i) {
    if (!t.contains(i)) note(t.insert(i, s.x.col(i), s.w[i]));
  }
  const auto defects = t.audit();
  if (!defects.empty()) std::printf("DEFECT %s\n", defects.front().sentence.c_str());
  totals.defects += !defects.empty();

  Hash cells;
  if constexpr (Dim == 2) {
    const Eigen::AlignedBox2d box(Vec<2>(-1e7, -1e7), Vec<2>(1e7, 1e7));
    for (int i = 0; i < s.size(); ++i) {
      const Columns<2> cell = laguerre_cell(t, i, box);
      for (const double number : cell.reshaped()) cells.add(number);
    }
  }
  std::printf("%s: sites %016" PRIx64 " T %016" PRIx64 " cells %016" PRIx64 "\n", s.name.c_str(),
              given.value(), come.value(), cells.value());
  std::fflush(stdout);  // where signs are wrong this may not end
}

/// Sets in space that are the same on every machine. Powers differ in the last bit from one C
/// library to another, and random numbers that are operands are drawn in any order.
std::vector<test3::Sites> sets_in_space(Random& random) {
  return {test3::jittered(random, 4), test3::overlapping(random, 60),
          test3::cubic_lattice(4, 1), test3::cubic_lattice(4, 0.1 * std::sqrt(2.0)),
          test3::fcc_lattice(5, 1),   test3::integers(random, 60, 5, 3),
          test3::hcp_lattice(4, 1),   test3::collinear(random, 30)};
}

/// Signs of sites that are nearly or exactly degenerate, at scales from 2^-120 to 2^120.
void try_signs() {
  Random random(99);
  Hash signs;
  int zeros = 0, all = 0;
  for (int k = 0; k < 200000; ++k) {
    const double scale = std::ldexp(1.0, random.below(7) * 40 - 120);
    const double ulp = std::ldexp(scale, -52);
    Site2 p[4];
    for (Site2& site : p) {
      const double a = random.below(5), b = random.below(5);
      site = {scale * a + ulp * random.below(3), scale * b + ulp * random.below(3),
              scale * scale * random.below(3)};
      if (k % 3 == 0) {
        site = {scale * (0.1 * a), scale * (0.1 * b), 0.25 * (scale * 0.1) * (scale * 0.1)};
      }
      if (k % 5 == 0) site.x += 1e6 * scale;
    }
    for (const int sign : {orientation(p[0], p[1], p[2]), power_side(p[0], p[1], p[2], p[3])}) {
      signs.add(sign);
      zeros += sign == 0;
      ++all;
    }
  }
  std::printf("signs %016" PRIx64 ", %d of %d are zero\n", signs.value(), zeros, all);
  Hash map;
  const int differ = sign_map(256, 0.5, 0.5, 12, 12, 24, 24);
  for (int k = 0; k < lagrain_int_count(); ++k) map.add(lagrain_ints()[k]);
  std::printf("map of signs %016" PRIx64 ", %d of doubles are wrong\n", map.value(), differ);
}

/// Scenes are told a restitution. The damping ratio that follows is the same with every C library.
void try_scenes() {
  Hash ratios;
  for (int k = 1; k < 2000; ++k) ratios.add(damping_ratio_for(k / 2000.0));
  std::printf("damping ratios %016" PRIx64 "\n", ratios.value());
  for (const int kind : {0, 1, 2, 3}) {
    if (!grains_start(kind, 200, 1, 0.3, 0.5) || !grains_step(5000) || !grains_report()) {
      std::printf("FAILED: %s\n", lagrain_error());
      std::exit(1);
    }
    const double missed = lagrain_reals()[15];
    grains_hash();
    std::printf("scene %d after 5000 steps %08x%08x, %g contacts missed\n", kind,
                static_cast<unsigned>(lagrain_ints()[0]), static_cast<unsigned>(lagrain_ints()[1]),
                missed);
  }
}

}  // namespace
}  // namespace lagrain

int main(int argc, char** argv) {
  using namespace lagrain;
  const auto start = std::chrono::steady_clock::now();
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 84;
  Totals totals;
  for (int seed = 0; seed < seeds; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    auto sets = test::all_kinds(random);
    sets.push_back(test::collinear(random, 40));
    for (auto& s : sets) try_set<2>(std::move(s), random, totals);
    if (seed % 4 != 0) continue;
    for (auto& s : sets_in_space(random)) try_set<3>(std::move(s), random, totals);
  }
  try_signs();
  try_scenes();
  std::printf("%d sets, %d updates, %d defects\n", totals.sets, totals.updates, totals.defects);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  std::fprintf(stderr, "%.1f s\n", taken.count());
  return totals.defects == 0 ? 0 : 1;
}
