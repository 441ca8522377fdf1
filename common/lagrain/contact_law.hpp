// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What a contact law is. A law is a small immutable aggregate of SI numbers; laws compose by
/// holding another law.

#include <lagrain/dashpot.hpp>
#include <lagrain/needs.hpp>
#include <lagrain/touch.hpp>

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
/// * `respond` advances the memory by the time step [s] and returns the force [N] and the losses
///   [J]. With time step 0, for those who only look, it changes nothing: dashpots then exert what
///   they do at this moment (see Onset), and springs what their memory holds.
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
