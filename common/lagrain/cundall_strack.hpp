#pragma once
/// @file
/// Coulomb friction with an elastic tangential spring, over any normal law.

#include <lagrain/contact_law.hpp>
#include <lagrain/hertz.hpp>
#include <lagrain/hooke.hpp>

#include <algorithm>
#include <cmath>

namespace lagrain {

/// Friction that holds: a tangential spring xi stretched by the slip, cut at Coulomb's limit.
///
///     f_t = -(kt xi + gt slip),  |f_t| <= mu f_n,
///     kt = ratio x normal stiffness,  gt = 2 zeta_t sqrt(kt m_eff)
///
/// The spring is cut at the limit by itself, then its sum with the dashpot is cut again. So a large
/// dashpot can neither load the spring nor change the impulse of a grazing impact, and friction
/// never gives energy: with X = kt xi inside the ball of radius mu f_n and P the point of the ball
/// nearest to X + gt slip, the loss is slip . (P - X) >= |P - X|^2 / gt.
///
/// Source: Cundall & Strack, Geotechnique 29 (1979) 47.
template <class Normal>
struct CundallStrack {
  static constexpr Needs needs{.spin = true, .memory = true};

  /// Stretch of the tangential spring [m], in the contact plane.
  template <int Dim>
  struct Memory {
    Vec<Dim> stretch = Vec<Dim>::Zero();
    bool operator==(const Memory&) const = default;
  };

  Normal normal;
  double friction = 0;                  ///< mu [-]
  double stiffness_ratio = 2.0 / 7.0;   ///< kt / kn [-]
  double tangential_damping_ratio = 0;  ///< zeta_t [-]

  template <int Dim>
  Response<Dim> respond(const Touch<Dim>& touch, Memory<Dim>& memory, double time_step) const {
    Response<Dim> response;
    const double fn = normal.normal_force(touch);
    response.dashpot_loss = (fn - normal.elastic_force(touch)) * touch.closing * time_step;

    const double kt = stiffness_ratio * normal.stiffness_at(touch);
    const double gt = 2 * tangential_damping_ratio * std::sqrt(kt * touch.effective_mass);
    Vec<Dim> xi = turned_with<Dim>(memory.stretch, touch, time_step);
    const double stored = 0.5 * kt * xi.squaredNorm();
    xi = cut<Dim>(xi + time_step * touch.slip, friction * fn / kt);
    const Vec<Dim> ft = cut<Dim>(-(kt * xi + gt * touch.slip), friction * fn);
    memory.stretch = xi;
    response.force = fn * touch.normal + ft;
    response.friction_loss =
        -ft.dot(touch.slip) * time_step - (0.5 * kt * xi.squaredNorm() - stored);
    return response;
  }

  template <int Dim>
  double elastic_energy(const Touch<Dim>& touch, const Memory<Dim>& memory) const {
    return normal.elastic_energy(touch, NoMemory{}) +
           0.5 * stiffness_ratio * normal.stiffness_at(touch) * memory.stretch.squaredNorm();
  }

  double contact_time(double effective_mass, double effective_radius) const {
    return normal.contact_time(effective_mass, effective_radius);
  }
  double natural_time(double effective_mass, double effective_radius) const {
    return normal.natural_time(effective_mass, effective_radius);
  }
  double largest_damping_ratio() const {
    return std::max(normal.largest_damping_ratio(),
                    kTangentialMobility * tangential_damping_ratio * std::sqrt(stiffness_ratio));
  }
  bool conservative() const { return false; }

 private:
  /// v, shortened to at most `length`.
  template <int Dim>
  static Vec<Dim> cut(const Vec<Dim>& v, double length) {
    const double squared = v.squaredNorm();
    return squared > length * length ? Vec<Dim>(length / std::sqrt(squared) * v) : v;
  }

  /// The stretch follows the contact as it turns: about the normal by the twist of the step, and
  /// with the normal, whose part is dropped. The length is kept.
  template <int Dim>
  static Vec<Dim> turned_with(const Vec<Dim>& stretch, const Touch<Dim>& touch, double time_step) {
    const double before = stretch.squaredNorm();
    if (before == 0) return stretch;
    const Vec<Dim> flat = stretch - stretch.dot(touch.normal) * touch.normal +
                          cross(SpinVec<Dim>(time_step * touch.twist), stretch);
    const double after = flat.squaredNorm();
    if (after == 0) return flat;
    return std::sqrt(before / after) * flat;
  }
};

static_assert(ContactLaw<CundallStrack<LinearSpring>, 2> &&
              ContactLaw<CundallStrack<LinearSpring>, 3>);
static_assert(ContactLaw<CundallStrack<Hertz>, 2> && ContactLaw<CundallStrack<Hertz>, 3>);

}  // namespace lagrain
