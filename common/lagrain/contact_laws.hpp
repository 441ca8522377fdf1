// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The contact laws that lagrain knows, each in one row. Scene files, their messages, the choice of
/// types at run time, and what is compiled in advance are all made from the rows of this file.
///
/// To add a normal law, write its header and its test, include it here, add a line to
/// LAGRAIN_NORMAL_LAWS, and give it an entry with its keys below. Without the entry nothing
/// compiles. A program of one's own that brings its law along needs none of this: `Simulation`
/// takes any type that is a ContactLaw.

#include <lagrain/cundall_strack.hpp>
#include <lagrain/hertz.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/needs.hpp>
#include <lagrain/rolling_resistance.hpp>
#include <lagrain/viscous_friction.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace lagrain {

/// No friction: the law is the normal law alone.
template <class Normal>
using Frictionless = Normal;
/// Elastic friction that resists rolling as well.
template <class Normal>
using RollingFriction = RollingResistance<CundallStrack<Normal>>;

/// Rows of the lists: ROW(word of the scene file, type). What follows ROW is passed on to it.
#define LAGRAIN_NORMAL_LAWS(ROW, ...)                  \
  ROW(linear, LinearSpring __VA_OPT__(, ) __VA_ARGS__) \
  ROW(hertz, Hertz __VA_OPT__(, ) __VA_ARGS__)
/// Friction laws are templates over a normal law.
#define LAGRAIN_FRICTION_LAWS(ROW, ...)                    \
  ROW(none, Frictionless __VA_OPT__(, ) __VA_ARGS__)       \
  ROW(viscous, ViscousFriction __VA_OPT__(, ) __VA_ARGS__) \
  ROW(elastic, CundallStrack __VA_OPT__(, ) __VA_ARGS__)   \
  ROW(rolling, RollingFriction __VA_OPT__(, ) __VA_ARGS__)

/// The word of a row.
#define LAGRAIN_WORD(word, Law) word,
/// The normal laws, by their words.
enum class NormalModel { LAGRAIN_NORMAL_LAWS(LAGRAIN_WORD) };
/// The friction laws, by their words.
enum class FrictionModel { LAGRAIN_FRICTION_LAWS(LAGRAIN_WORD) };
#undef LAGRAIN_WORD

/// The numbers from which laws are made; each law uses those that its keys name.
struct LawNumbers {
  double stiffness = 0;     ///< k [N/m]
  double modulus = 0;       ///< E* [Pa]
  double impact_speed = 0;  ///< the fastest collision expected [m/s]
  double restitution = 1;   ///< [-]
  double friction = 0;      ///< mu [-]
  double stiffness_ratio =
      CundallStrack<LinearSpring>{}.stiffness_ratio;  ///< tangential over normal stiffness [-]
  double tangential_damping = 0;                      ///< damping ratio [-]
  double rolling_friction = 0;                        ///< mu_r [-]
  double twisting_friction = 0;                       ///< mu_t [-]
  double rolling_stiffness_ratio =
      RollingFriction<LinearSpring>{}.stiffness_ratio;  ///< rolling stiffness over k_n R_eff^2 [-]
  double rolling_damping = 0;                           ///< damping ratio [-]
};

/// Which numbers a key accepts.
enum class Range { any, not_negative, positive, fraction /* above 0 and at most 1 */ };

/// A key of the scene's table [law].
struct LawKey {
  std::string_view name;             ///< as in the scene file
  std::string_view what;             ///< with its article: "a stiffness"
  std::string_view unit;             ///< SI; empty for a pure number
  Range range;                       ///< what it accepts
  double LawNumbers::*number;        ///< where it goes
  std::optional<double> fallback{};  ///< taken if the key is missing; none: the key is required
  bool in_space_only = false;        ///< in the plane it is refused
};

namespace law_keys {
/// The key of a linear spring's stiffness.
inline constexpr LawKey kStiffness{"stiffness", "a stiffness", "N/m", Range::positive,
                                   &LawNumbers::stiffness};
/// The key of the effective modulus.
inline constexpr LawKey kModulus{"modulus", "a modulus", "Pa", Range::positive,
                                 &LawNumbers::modulus};
/// The key of the fastest collision expected.
inline constexpr LawKey kImpactSpeed{"impact_speed", "a speed", "m/s", Range::positive,
                                     &LawNumbers::impact_speed};
/// The key of the restitution of a head-on impact.
inline constexpr LawKey kRestitution{"restitution", "a number", "", Range::fraction,
                                     &LawNumbers::restitution};
/// The key of Coulomb's coefficient.
inline constexpr LawKey kFriction{"friction", "a number", "", Range::not_negative,
                                  &LawNumbers::friction};
/// The keys of an elastic tangential spring.
/// @{
inline constexpr LawKey kElasticDamping{"tangential_damping",
                                        "a number",
                                        "",
                                        Range::not_negative,
                                        &LawNumbers::tangential_damping,
                                        CundallStrack<LinearSpring>{}.tangential_damping_ratio};
inline constexpr LawKey kStiffnessRatio{"stiffness_ratio",
                                        "a number",
                                        "",
                                        Range::positive,
                                        &LawNumbers::stiffness_ratio,
                                        CundallStrack<LinearSpring>{}.stiffness_ratio};
/// @}
}  // namespace law_keys

/// The entry of a normal law: what it is called, its keys, and how it is made from their numbers.
template <class Normal>
struct NormalLawEntry;

/// The entry of LinearSpring.
template <>
struct NormalLawEntry<LinearSpring> {
  /// What people call it.
  static constexpr std::string_view kInWords = "linear spring and dashpot";
  /// The keys that it reads.
  static constexpr std::array kKeys{law_keys::kStiffness, law_keys::kRestitution};
  /// The law that numbers describe.
  static LinearSpring make(const LawNumbers& n) {
    return LinearSpring::with_restitution(n.stiffness, n.restitution);
  }
};

/// The entry of Hertz.
template <>
struct NormalLawEntry<Hertz> {
  /// What people call it.
  static constexpr std::string_view kInWords = "Hertz with viscous damping";
  /// The keys that it reads.
  static constexpr std::array kKeys{law_keys::kModulus, law_keys::kImpactSpeed,
                                    law_keys::kRestitution};
  /// The law that numbers describe.
  static Hertz make(const LawNumbers& n) {
    return Hertz::with_restitution(n.modulus, n.restitution, n.impact_speed);
  }
};

/// The entry of a friction law: as above, made over a normal law.
template <template <class> class Friction>
struct FrictionLawEntry;

/// The entry of no friction.
template <>
struct FrictionLawEntry<Frictionless> {
  static constexpr std::string_view kInWords = "no friction";  ///< what people call it
  static constexpr std::array<LawKey, 0> kKeys{};              ///< it reads no key
  /// The friction law over a normal law, from the numbers.
  template <class Normal>
  static Normal over(const Normal& normal, const LawNumbers&) {
    return normal;
  }
};

/// The entry of ViscousFriction.
template <>
struct FrictionLawEntry<ViscousFriction> {
  /// What people call it.
  static constexpr std::string_view kInWords = "viscous friction cut at Coulomb's limit";
  /// Without damping this friction would not act at all.
  static constexpr std::array kKeys{
      law_keys::kFriction,
      LawKey{"tangential_damping", "a number", "", Range::positive, &LawNumbers::tangential_damping,
             ViscousFriction<LinearSpring>{}.tangential_damping_ratio}};
  /// The friction law over a normal law, from the numbers.
  template <class Normal>
  static ViscousFriction<Normal> over(const Normal& normal, const LawNumbers& n) {
    return {normal, n.friction, n.tangential_damping};
  }
};

/// The entry of CundallStrack.
template <>
struct FrictionLawEntry<CundallStrack> {
  /// What people call it.
  static constexpr std::string_view kInWords = "Coulomb friction with elastic memory";
  /// The keys that it reads.
  static constexpr std::array kKeys{law_keys::kFriction, law_keys::kElasticDamping,
                                    law_keys::kStiffnessRatio};
  /// The friction law over a normal law, from the numbers.
  template <class Normal>
  static CundallStrack<Normal> over(const Normal& normal, const LawNumbers& n) {
    return {normal, n.friction, n.stiffness_ratio, n.tangential_damping};
  }
};

/// The entry of RollingFriction.
template <>
struct FrictionLawEntry<RollingFriction> {
  /// What people call it.
  static constexpr std::string_view kInWords =
      "Coulomb friction with elastic memory and rolling resistance";
  /// The keys that it reads. In the plane nothing twists.
  static constexpr std::array kKeys{
      law_keys::kFriction,
      law_keys::kElasticDamping,
      law_keys::kStiffnessRatio,
      LawKey{"rolling_friction", "a number", "", Range::not_negative,
             &LawNumbers::rolling_friction},
      LawKey{"rolling_damping", "a number", "", Range::not_negative, &LawNumbers::rolling_damping,
             RollingFriction<LinearSpring>{}.damping_ratio},
      LawKey{"rolling_stiffness_ratio", "a number", "", Range::positive,
             &LawNumbers::rolling_stiffness_ratio, RollingFriction<LinearSpring>{}.stiffness_ratio},
      LawKey{"twisting_friction", "a number", "", Range::not_negative,
             &LawNumbers::twisting_friction, RollingFriction<LinearSpring>{}.twisting_friction,
             true}};
  /// The friction law over a normal law, from the numbers.
  template <class Normal>
  static RollingFriction<Normal> over(const Normal& normal, const LawNumbers& n) {
    return {FrictionLawEntry<CundallStrack>::over(normal, n), n.rolling_friction,
            n.twisting_friction, n.rolling_stiffness_ratio, n.rolling_damping};
  }
};

/// @cond
#define LAGRAIN_IS_LAW(word, Normal, Friction) \
  static_assert(ContactLaw<Friction<Normal>, 2> && ContactLaw<Friction<Normal>, 3>);
#define LAGRAIN_ARE_LAWS(word, Friction) LAGRAIN_NORMAL_LAWS(LAGRAIN_IS_LAW, Friction)
LAGRAIN_FRICTION_LAWS(LAGRAIN_ARE_LAWS)
#undef LAGRAIN_ARE_LAWS
#undef LAGRAIN_IS_LAW
/// @endcond

/// An entry as data.
struct LawDescription {
  std::string_view word;         ///< of the scene file
  std::string_view in_words;     ///< for people
  std::span<const LawKey> keys;  ///< that it reads
};

/// The description of a row.
#define LAGRAIN_DESCRIBE(word, Law, Entry) \
  LawDescription{#word, Entry<Law>::kInWords, Entry<Law>::kKeys},
/// All normal laws, in the order of the list.
inline constexpr std::array kNormalLaws{LAGRAIN_NORMAL_LAWS(LAGRAIN_DESCRIBE, NormalLawEntry)};
/// All friction laws, in the order of the list.
inline constexpr std::array kFrictionLaws{
    LAGRAIN_FRICTION_LAWS(LAGRAIN_DESCRIBE, FrictionLawEntry)};
#undef LAGRAIN_DESCRIBE

/// The description of a law.
/// @{
inline constexpr const LawDescription& description_of(NormalModel model) {
  return kNormalLaws[static_cast<std::size_t>(model)];
}
inline constexpr const LawDescription& description_of(FrictionModel model) {
  return kFrictionLaws[static_cast<std::size_t>(model)];
}
/// @}

/// The law that numbers describe.
template <class Normal, template <class> class Friction>
Friction<Normal> make_law(const LawNumbers& numbers) {
  return FrictionLawEntry<Friction>::over(NormalLawEntry<Normal>::make(numbers), numbers);
}

}  // namespace lagrain
