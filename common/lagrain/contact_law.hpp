// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What a contact law is. A law is a small immutable aggregate of SI numbers; laws compose by
/// holding another law.

#include <lagrain/dashpot.hpp>
#include <lagrain/needs.hpp>
#include <lagrain/touch.hpp>
#include <lagrain/vec.hpp>

#include <cmath>
#include <concepts>

namespace lagrain {

/// History of a contact without history.
struct NoMemory {
  static constexpr int kReals = 0;                   ///< it holds no number
  NoMemory seen_from_partner() const { return {}; }  ///< the same nothing
  bool operator==(const NoMemory&) const = default;
};

/// A law of contact in Dim dimensions, written over a number type: double for one contact, Lanes
/// for several at once.
///
/// * `needs` says what grains and contacts have to store for it.
/// * `Memory<Dim, Real>` is what a contact remembers: kReals numbers, reached by [], zero at first;
///   `seen_from_partner` gives what the partner's side of the contact remembers.
/// * `respond` advances the memory by the time step [s] and returns the force [N], the losses [J]
///   and, if `needs` says that it resists rolling, a moment [N m]. With time step 0, for those who
///   only look, it changes nothing: dashpots then exert what they do at this moment (see Onset),
///   and springs what their memory holds.
/// * `elastic_energy` is what the springs of the contact hold [J].
/// * `contact_time` is the duration of a free collision [s], from the effective mass [kg] and the
///   effective radius [m]. The time step is chosen from it.
/// * `natural_time` is 1 / omega0 of the spring [s], from the same two.
/// * `largest_damping_ratio` is the strongest dashpot, in units of 2 m_eff omega0 [-].
/// * `conservative` says whether no contact loses energy, as integrators of higher order require.
template <class L, int Dim>
concept ContactLaw = requires(const L law, const Touch<Dim>& touch,
                              typename L::template Memory<Dim>& memory,
                              const typename L::template Memory<Dim>& past, double x) {
  { L::needs } -> std::convertible_to<Needs>;
  { L::template Memory<Dim>::kReals } -> std::convertible_to<int>;
  { past.seen_from_partner() } -> std::same_as<typename L::template Memory<Dim>>;
  { law.respond(touch, memory, x) } -> std::same_as<Response<Dim>>;    // time step [s]
  { law.elastic_energy(touch, past) } -> std::convertible_to<double>;  // [J]
  // effective mass [kg], effective radius [m]
  { law.contact_time(x, x) } -> std::convertible_to<double>;
  { law.natural_time(x, x) } -> std::convertible_to<double>;
  { law.largest_damping_ratio() } -> std::convertible_to<double>;
  { law.conservative() } -> std::convertible_to<bool>;
}
&&std::default_initializable<typename L::template Memory<Dim>>;

/// Against tangential forces packings yield more easily than along the normal, because grains also
/// turn. In a closest packing whose grains all turn alike a tangential dashpot damps 24 / 6
/// (discs) and 40 / 8 times (spheres) as much as a normal one does in its stiffest mode. We take
/// the larger.
inline constexpr double kTangentialMobility = 5;

/// A vector that a contact remembers, such as the stretch of its tangential spring, follows the
/// contact as it turns: about the normal by the twist of the step, and with the normal, whose part
/// is dropped. The length is kept. In the plane an angle has no direction to follow.
/// @{
template <int Dim, class Real>
Vec<Dim, Real> turned_with(const Vec<Dim, Real>& stretch, const Touch<Dim, Real>& touch,
                           double time_step) {
  using std::sqrt;
  const Vec<Dim, Real> flat = stretch - dot(stretch, touch.normal) * touch.normal +
                              cross<Real>(SpinVec<Dim, Real>(time_step * touch.twist), stretch);
  const Real before = squared(stretch), after = squared(flat);
  return select(after > Real(0), Real(sqrt(before / after)), Real(1)) * flat;
}
template <class Real>
SpinVec<2, Real> turned_with(const SpinVec<2, Real>& angle, const Touch<2, Real>&, double) {
  return angle;
}
/// @}
/// v, shortened to at most `length`.
template <class V>
V shortened(const V& v, const typename V::Scalar& length) {
  using std::sqrt;
  using Real = typename V::Scalar;
  const Real length_squared = squared(v);
  const auto longer = length_squared > length * length;
  if (!any(longer)) return v;
  return select(longer, Real(length / sqrt(length_squared)), Real(1)) * v;
}

/// A law along the normal alone, which friction laws build on. `push` is the force [N], never
/// negative, and the dashpot's loss [J] in a time step [s]; `elastic_force` is the force without
/// the dashpot [N]; `stiffness_at` is its slope against the overlap [N/m], and kConstantStiffness
/// says whether that is one number. `kDashpotMean` is the mean of the dashpot's coefficient between
/// no overlap and some, over the one there [-].
template <class L, int Dim>
concept NormalLaw = ContactLaw<L, Dim> && requires(const L law, const Touch<Dim>& touch, double x) {
  { L::kConstantStiffness } -> std::convertible_to<bool>;
  { L::kDashpotMean } -> std::convertible_to<double>;
  { law.push(touch, x) } -> std::same_as<NormalPush<double>>;
  { law.elastic_force(touch) } -> std::convertible_to<double>;
  { law.stiffness_at(touch) } -> std::convertible_to<double>;
};

}  // namespace lagrain
