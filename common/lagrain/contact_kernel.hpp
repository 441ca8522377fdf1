// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The contacts of a list computed with the widest instructions that the machine has, chosen at
/// run time.

#include <lagrain/check.hpp>
#include <lagrain/contact_scene.hpp>
#include <lagrain/contact_sweep.hpp>
#include <lagrain/lanes.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/pair_table.hpp>
#include <lagrain/vec.hpp>

#include <cstddef>
#include <vector>

namespace lagrain {

/// Instructions that contacts are computed with. `scalar` is the oracle of the others.
enum class InstructionSet { scalar, avx2, avx512 };

/// The sets that this machine has, the narrowest first; the last is the default.
const std::vector<InstructionSet>& instruction_sets();

/// Passes over the contacts of a list: contact_sweep.hpp, compiled for every instruction set.
/// Results do not depend on the set, bit for bit.
template <int Dim, class Law>
class ContactKernel {
 public:
  static constexpr Needs needs = Law::needs;          ///< what the law needs
  using Memory = typename Law::template Memory<Dim>;  ///< what a contact remembers
  using Scene = ContactScene<Dim, Law>;               ///< what all contacts share

  /// @param one_law  all contacts between grains follow the first law of the table
  ContactKernel(InstructionSet set, bool one_law);

  /// All contacts of the table: adds their forces to the loads of both grains or, if `out` is
  /// given, leaves them there, at the places of the contacts in the table.
  Tally pairs(const Scene& scene, PairTable<Pair, Memory>& table, Listing listing,
              PairLoad<Dim, needs>* out = nullptr) const {
    return pairs_(scene, table, listing, out);
  }
  /// Contacts with walls: adds their forces to the loads, and the opposite to wall_loads, one for
  /// each wall of the scene.
  Tally walls(const Scene& scene, PairTable<WallPair, Memory>& table,
              WallLoad<Dim>* wall_loads) const {
    return walls_(scene, table, wall_loads);
  }

 private:
  using PairSweep = Tally (*)(const Scene&, PairTable<Pair, Memory>&, Listing,
                              PairLoad<Dim, needs>*);
  using WallSweep = Tally (*)(const Scene&, PairTable<WallPair, Memory>&, WallLoad<Dim>*);
  PairSweep pairs_;
  WallSweep walls_;
};

namespace detail {

/// The sweeps for one number type.
template <int Dim, class Law, class Real>
struct Sweeps {
  using Scene = ContactScene<Dim, Law>;
  using Memory = typename Law::template Memory<Dim>;

  template <bool kOneLaw>
  static Tally pairs(const Scene& scene, PairTable<Pair, Memory>& table, Listing listing,
                     PairLoad<Dim, Law::needs>* out) {
    if (listing == Listing::loose) {
      return sweep_picked<Dim, Law, Real, kOneLaw>(scene, table, out);
    }
    return sweep_over<Dim, Law, Real, kOneLaw>(
        scene, table.size(), [&](auto& sweep, std::size_t first, std::size_t partial) {
          sweep.pairs(table, InRow{first}, partial, out);
        });
  }
  static Tally walls(const Scene& scene, PairTable<WallPair, Memory>& table,
                     WallLoad<Dim>* wall_loads) {
    return sweep_over<Dim, Law, Real, false>(
        scene, table.size(), [&](auto& sweep, std::size_t first, std::size_t partial) {
          sweep.walls(table, first, partial, wall_loads);
        });
  }
};

// The sweeps compiled for one instruction set each, everything inlined (except with sanitizers,
// whose checks the compiler would inline for half an hour).
#if defined(__SANITIZE_ADDRESS__)
/// Attribute of a sweep: all that it calls is compiled into it.
#define LAGRAIN_INLINED
#else
/// Attribute of a sweep: all that it calls is compiled into it.
#define LAGRAIN_INLINED gnu::flatten
#endif
/// Attributes of a sweep for AVX2.
#define LAGRAIN_FOR_AVX2 [[gnu::target("avx2"), LAGRAIN_INLINED]]
/// Attributes of a sweep for AVX-512.
#define LAGRAIN_FOR_AVX512 [[gnu::target("avx512f,avx512dq,avx512vl"), LAGRAIN_INLINED]]
/// Defines the sweeps for one instruction set.
#define LAGRAIN_COMPILED_SWEEPS(Name, Attributes, Real)                                            \
  template <int Dim, class Law>                                                                    \
  struct Name {                                                                                    \
    using S = Sweeps<Dim, Law, Real>;                                                              \
    using Memory = typename S::Memory;                                                             \
    template <bool kOneLaw>                                                                        \
    Attributes static Tally pairs(const typename S::Scene& scene, PairTable<Pair, Memory>& table,  \
                                  Listing listing, PairLoad<Dim, Law::needs>* out) {               \
      return S::template pairs<kOneLaw>(scene, table, listing, out);                               \
    }                                                                                              \
    Attributes static Tally walls(const typename S::Scene& scene,                                  \
                                  PairTable<WallPair, Memory>& table, WallLoad<Dim>* wall_loads) { \
      return S::walls(scene, table, wall_loads);                                                   \
    }                                                                                              \
  }
LAGRAIN_COMPILED_SWEEPS(ScalarSweeps, [[LAGRAIN_INLINED]], double);
#if defined(__x86_64__)
LAGRAIN_COMPILED_SWEEPS(Avx2Sweeps, LAGRAIN_FOR_AVX2, Lanes<4>);
LAGRAIN_COMPILED_SWEEPS(Avx512Sweeps, LAGRAIN_FOR_AVX512, Lanes<8>);
#endif
#undef LAGRAIN_COMPILED_SWEEPS
#undef LAGRAIN_INLINED
#undef LAGRAIN_FOR_AVX2
#undef LAGRAIN_FOR_AVX512

}  // namespace detail

template <int Dim, class Law>
ContactKernel<Dim, Law>::ContactKernel(InstructionSet set, bool one_law) {
  const auto choose = [&]<class S>(S) {
    pairs_ = one_law ? &S::template pairs<true> : &S::template pairs<false>;
    walls_ = &S::walls;
  };
  switch (set) {
    case InstructionSet::scalar:
      choose(detail::ScalarSweeps<Dim, Law>{});
      return;
#if defined(__x86_64__)
    case InstructionSet::avx2:
      choose(detail::Avx2Sweeps<Dim, Law>{});
      return;
    case InstructionSet::avx512:
      choose(detail::Avx512Sweeps<Dim, Law>{});
      return;
#else
    case InstructionSet::avx2:
    case InstructionSet::avx512:
      break;
#endif
  }
  LAGRAIN_EXPECTS(false, "this processor does not have the instruction set");
}

}  // namespace lagrain
