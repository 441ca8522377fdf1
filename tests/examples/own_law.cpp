// SPDX-License-Identifier: GPL-3.0-or-later
// A contact law of your own: a spring that yields (Walton & Braun, J. Rheology 30 (1986) 949). The
// stiffness is k1 under load and k2 > k1 afterwards, so a dent remains, and an impact has the
// restitution sqrt(k1 / k2) at any speed. To build it: find_package(lagrain 0.1), lagrain::common.

#include <lagrain/all_pairs.hpp>
#include <lagrain/observe.hpp>

#include <cmath>
#include <cstdio>

using namespace lagrain;

struct YieldingSpring {
  static constexpr Needs needs{};          // grains need not turn
  template <int Dim, class Real = double>  // Real is one number, or several side by side
  struct Memory {
    static constexpr int kReals = 1;
    Real deepest = Real(0);  // overlap so far [m]
    Real& operator[](int) { return deepest; }
    const Real& operator[](int) const { return deepest; }
    Memory seen_from_partner() const { return *this; }
  };
  double loading, unloading;                               // k1 <= k2 [N/m]
  double dent() const { return 1 - loading / unloading; }  // of the deepest overlap [-]
  template <int Dim, class Real>
  Response<Dim, Real> respond(const Touch<Dim, Real>& touch, Memory<Dim, Real>& memory,
                              double time_step) const {
    const auto yields = touch.overlap > memory.deepest;
    memory.deepest = larger(memory.deepest, touch.overlap);
    const Real f = unloading * positive_part(Real(touch.overlap - dent() * memory.deepest));
    return {f * touch.normal, only_if(yields, Real(dent() * f * touch.closing * time_step)), 0};
  }
  template <int Dim>
  double elastic_energy(const Touch<Dim>& touch, const Memory<Dim>& memory) const {
    return 0.5 * unloading * std::pow(std::max(0., touch.overlap - dent() * memory.deepest), 2);
  }
  double natural_time(double mass, double) const { return std::sqrt(mass / unloading); }
  double contact_time(double mass, double) const {
    return 1.5708 * (std::sqrt(mass / loading) + std::sqrt(mass / unloading));
  }
  double largest_damping_ratio() const { return 0; }
  bool conservative() const { return false; }
};

int main() {
  const YieldingSpring law{.loading = 1e5, .unloading = 4e5};
  for (const double speed : {0.1, 1.0}) {  // of approach [m/s]
    const std::vector<Grain<3>> balls{{.velocity = {speed, 0, 0}, .radius = 0.01, .mass = 0.01},
                                      {.position = {0.02, 0, 0}, .radius = 0.01, .mass = 0.01}};
    const double duration = law.contact_time(0.005, 0.005);  // of the effective mass [kg]
    Simulation<3, YieldingSpring, VelocityVerlet, AllPairs<3>> sim(
        make_grains<3, Needs{}>(balls), LawTable(law), {}, {.time_step = duration / 1000});
    const double energy = energy_ledger(sim).balance();
    while (sim.time() < 2 * duration) sim.step();
    const double restitution = (sim.grains().velocity(0, 1) - sim.grains().velocity(0, 0)) / speed;
    const double lost = std::abs(energy_ledger(sim).balance() / energy - 1);
    std::printf("%.1f m/s: restitution %.6f; ledger off by %.0e\n", speed, restitution, lost);
    if (!(std::abs(restitution - 0.5) < 1e-5 && lost < 1e-5)) return 1;  // sqrt(k1 / k2) = 0.5
  }
}
