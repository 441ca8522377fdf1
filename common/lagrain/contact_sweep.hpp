// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The inner loop of a time step: all contacts of a list, several at once.
///
/// A law is written over a number type (touch.hpp). Here it is run with Lanes; what does not fill
/// the lanes runs with `double`. Forces are always added in the order of the list, and losses in
/// the same partial sums, so results do not depend on the width, bit for bit.
///
/// A contact goes through four stages: *gather* its grains from memory into lanes, *touch* (do they
/// overlap, and how: the paper's step 2), *respond* (the law: step 3), *scatter* force and torque
/// back to the grains.

#include <lagrain/contact_law.hpp>
#include <lagrain/contact_scene.hpp>
#include <lagrain/lanes.hpp>
#include <lagrain/law_table.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/pair_table.hpp>
#include <lagrain/records.hpp>
#include <lagrain/touch.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace lagrain::detail {

/// Places of entries in a table: side by side, or picked.
struct InRow {
  std::size_t first;
  std::size_t operator[](std::size_t k) const { return first + k; }
};
struct Picked {
  const std::size_t* at;
  std::size_t operator[](std::size_t k) const { return at[k]; }
};

/// What sweeps of every width have added up. Each sum is kept as eight partial sums whatever the
/// width, so that every width adds the same numbers in the same order: the k-th contact that a
/// sweep meets counts in partial sum k mod 8.
class Sums {
 public:
  static constexpr std::size_t kPartialSums = 8;

  template <class S>
  void add(const S& sweep) {
    sweep.add_to(dashpot_, sweep.dashpot);
    sweep.add_to(friction_, sweep.friction);
    sweep.add_to(contacts_, sweep.contacts);
    std::array<double, kPartialSums> excess{};
    sweep.add_to(excess, sweep.excess);
    excess_ = std::max(excess_, *std::max_element(excess.begin(), excess.end()));
  }
  Tally total() const {
    Tally tally;
    tally.excess = excess_;
    for (std::size_t k = 0; k < kPartialSums; ++k) {
      tally.dashpot += dashpot_[k];
      tally.friction += friction_[k];
      tally.contacts += contacts_[k];
    }
    return tally;
  }

 private:
  std::array<double, kPartialSums> dashpot_{}, friction_{}, contacts_{};
  double excess_ = 0;
};

/// The code of a sweep, for contacts by kLanes<Real> at once. Inlined as a whole into functions for
/// one instruction set each.
///
/// @tparam kOneLaw  one law holds between all grains: the common case, and the fast one
template <int Dim, class Law, class Real, bool kOneLaw>
struct Sweep {
  static constexpr Needs needs = Law::needs;
  static constexpr std::size_t kWidth = kLanes<Real>;
  using Grain = GrainRecord<Dim, needs>;
  using Load = LoadRecord<Dim, needs>;
  using Memory = typename Law::template Memory<Dim, Real>;
  using Slots = std::array<int, kWidth>;

  static constexpr std::size_t kPartialSums = Sums::kPartialSums;
  using PartialSums = std::array<Real, kPartialSums / kWidth>;

  const ContactScene<Dim, Law>& scene;
  const Law only_law;  // a copy: what is the same for all contacts stays at hand
  PartialSums dashpot, friction, excess, contacts;

  explicit Sweep(const ContactScene<Dim, Law>& s) : scene(s), only_law(s.laws->between(0, 0)) {
    dashpot.fill(Real(0));
    friction.fill(Real(0));
    excess.fill(Real(0));
    contacts.fill(Real(0));
  }

  static void add_to(std::array<double, kPartialSums>& sums, const PartialSums& lanes) {
    for (std::size_t k = 0; k < kPartialSums; ++k) {
      sums[k] += lane(lanes[k / kWidth], static_cast<int>(k % kWidth));
    }
  }

  template <class P>
  static Memory read_memory(const PairTable<P, typename Law::template Memory<Dim>>& table,
                            InRow at) {
    Memory m;
    if constexpr (Memory::kReals > 0) {
      for (int r = 0; r < Memory::kReals; ++r) detail::read(m[r], table.memory_row(r) + at.first);
    }
    return m;
  }
  template <class P>
  static Memory read_memory(const PairTable<P, typename Law::template Memory<Dim>>& table,
                            Picked at) {
    Memory m;
    if constexpr (Memory::kReals > 0) {
      for (int r = 0; r < Memory::kReals; ++r) {
        const double* row = table.memory_row(r);
        for (std::size_t k = 0; k < kWidth; ++k) set_lane(m[r], static_cast<int>(k), row[at[k]]);
      }
    }
    return m;
  }
  template <class P>
  static void write_memory(PairTable<P, typename Law::template Memory<Dim>>& table, InRow at,
                           const Memory& m) {
    if constexpr (Memory::kReals > 0) {
      for (int r = 0; r < Memory::kReals; ++r) detail::write(table.memory_row(r) + at.first, m[r]);
    }
  }
  template <class P>
  static void write_memory(PairTable<P, typename Law::template Memory<Dim>>& table, Picked at,
                           const Memory& m) {
    if constexpr (Memory::kReals > 0) {
      for (int r = 0; r < Memory::kReals; ++r) {
        double* row = table.memory_row(r);
        for (std::size_t k = 0; k < kWidth; ++k) row[at[k]] = lane(m[r], static_cast<int>(k));
      }
    }
  }

  /// The law's answer where `touching`, zero elsewhere; `partner_material(k)` is that of lane k.
  template <class Mask, class PartnerMaterial>
  Response<Dim, Real> respond(const Touch<Dim, Real>& touch, const Mask& touching,
                              const Slots& slot, PartnerMaterial&& partner_material,
                              Memory& memory) const {
    Response<Dim, Real> response;
    if constexpr (kOneLaw) {
      response = only_law.respond(touch, memory, scene.time_step);
    } else {
      // One law after the other, each for its own lanes.
      std::array<const Law*, kWidth> law;
      for (std::size_t k = 0; k < kWidth; ++k) {
        law[k] = &scene.laws->between(scene.material(slot[k]), partner_material(k));
      }
      const Memory past = memory;
      for (std::size_t first = 0; first < kWidth; ++first) {
        const auto before = law.begin() + static_cast<std::ptrdiff_t>(first);
        if (std::find(law.begin(), before, law[first]) != before) continue;
        Memory tried = past;
        const Response<Dim, Real> answer = law[first]->respond(touch, tried, scene.time_step);
        const auto own =
            mask_of<Real>([&](int k) { return law[static_cast<std::size_t>(k)] == law[first]; });
        for (int d = 0; d < Dim; ++d) {
          response.force[d] = select(own, answer.force[d], response.force[d]);
        }
        if constexpr (needs.rolling) {
          for (int d = 0; d < kSpinDim<Dim>; ++d) {
            response.moment[d] = select(own, answer.moment[d], response.moment[d]);
          }
        }
        response.dashpot_loss = select(own, answer.dashpot_loss, response.dashpot_loss);
        response.friction_loss = select(own, answer.friction_loss, response.friction_loss);
        if constexpr (Memory::kReals > 0) {
          for (int r = 0; r < Memory::kReals; ++r) memory[r] = select(own, tried[r], memory[r]);
        }
      }
    }
    for (int d = 0; d < Dim; ++d) response.force[d] = only_if(touching, response.force[d]);
    if constexpr (needs.rolling) {
      for (Real& component : response.moment) component = only_if(touching, component);
    }
    response.dashpot_loss = only_if(touching, response.dashpot_loss);
    response.friction_loss = only_if(touching, response.friction_loss);
    if constexpr (Memory::kReals > 0) {
      for (int r = 0; r < Memory::kReals; ++r) memory[r] = only_if(touching, memory[r]);
    }
    return response;
  }

  template <class Mask>
  void note(const Response<Dim, Real>& response, const Mask& touching, const Real& beyond,
            std::size_t partial) {
    contacts[partial] += only_if(touching, Real(1));
    dashpot[partial] += response.dashpot_loss;
    friction[partial] += response.friction_loss;
    excess[partial] = larger(excess[partial], only_if(touching, beyond));
  }

  /// A load of each lane as four columns and, in space with spin, four more.
  struct LoadColumns {
    static constexpr bool kTwice = Load::kSize == 8;
    std::array<Real, 4> first, second;

    LoadColumns(const Vec<Dim, Real>& force, const SpinVec<Dim, Real>& turn) {
      first.fill(Real(0));
      second.fill(Real(0));
      for (std::size_t d = 0; d < Dim; ++d) first[d] = force[static_cast<int>(d)];
      if constexpr (needs.spin && kTwice) {
        for (std::size_t d = 0; d < 3; ++d) second[d] = turn[static_cast<int>(d)];
      } else if constexpr (needs.spin) {
        first[Load::kTorque] = turn[0];
      }
    }
  };
  /// The columns of a load as rows, one for each lane.
  struct LoadRows {
    detail::Rows<Real> first, second;

    explicit LoadRows(const LoadColumns& columns) : first(columns.first), second(columns.second) {}
    void add_to(Load& load, std::size_t k) const {
      first.add_to(load.at.data(), k);
      if constexpr (LoadColumns::kTwice) second.add_to(&load.at[4], k);
    }
    void subtract_from(Load& load, std::size_t k) const {
      first.subtract_from(load.at.data(), k);
      if constexpr (LoadColumns::kTwice) second.subtract_from(&load.at[4], k);
    }
  };

  /// Finds which of the pairs first, first + 1, ... of the table overlap, and adds them to
  /// `picked`. The others lose their memory, and leave no load in `out`.
  /// @returns the end of `picked`
  std::size_t* pick(PairTable<Pair, typename Law::template Memory<Dim>>& table, std::size_t first,
                    PairLoad<Dim, needs>* out, std::size_t* picked) const {
    std::array<const double*, kWidth> row_i, row_j;
    for (std::size_t k = 0; k < kWidth; ++k) {
      row_i[k] = scene.grains[table.pairs()[first + k].i].at.data();
      row_j[k] = scene.grains[table.pairs()[first + k].j].at.data();
    }
    // Places and radii come first in a record.
    static_assert(Grain::kPosition == 0 && Grain::kRadius == Dim && Dim < 4);
    std::array<Real, 4> i, j;
    read_columns<4>(row_i, i);
    read_columns<4>(row_j, j);
    Vec<Dim, Real> between;
    for (std::size_t d = 0; d < Dim; ++d) between[static_cast<int>(d)] = i[d] - j[d];
    const Real reach = i[Dim] + j[Dim];
    const auto overlapping = squared(between) < reach * reach;
    if constexpr (Memory::kReals > 0) {
      Memory memory = read_memory(table, InRow{first});
      for (int r = 0; r < Memory::kReals; ++r) memory[r] = only_if(overlapping, memory[r]);
      write_memory(table, InRow{first}, memory);
    }
    for (std::size_t k = 0; k < kWidth; ++k) {
      // Written in any case and counted if wanted: cheaper than a branch that nobody can predict.
      *picked = first + k;
      picked += lane(overlapping, static_cast<int>(k));
      if (out != nullptr) out[first + k] = {};
    }
    return picked;
  }

  /// The two grains of the pair in each lane, by slot and as bodies.
  struct PairOfLanes {
    Slots i, j;
    Body<Dim, needs, Real> body_i, body_j;
  };

  /// Reads the grains of the pairs at[0], at[1], ... from memory.
  template <class Places>
  PairOfLanes gather(const PairTable<Pair, typename Law::template Memory<Dim>>& table,
                     Places at) const {
    Slots i, j;
    for (std::size_t k = 0; k < kWidth; ++k) {
      i[k] = table.pairs()[at[k]].i;
      j[k] = table.pairs()[at[k]].j;
    }
    return {i, j, read_bodies<Real>(scene.grains, i), read_bodies<Real>(scene.grains, j)};
  }

  /// Adds force and torque to the loads of both grains, or leaves them at their places in `out`.
  template <class Places>
  void scatter(const PairOfLanes& pair, const Touch<Dim, Real>& touch,
               const Response<Dim, Real>& response, Places at, PairLoad<Dim, needs>* out) const {
    SpinVec<Dim, Real> turn_i, turn_j;
    if constexpr (needs.spin) {
      // Both forces act at one point, so that angular momentum is conserved exactly.
      const Real half = 0.5 * touch.overlap;
      const SpinVec<Dim, Real> couple = torque<Real>(touch.normal, response.force);
      turn_i = (half - pair.body_i.radius) * couple;
      turn_j = (pair.body_j.radius - half) * couple;
    }
    if constexpr (needs.rolling) {
      turn_i += response.moment;
      turn_j += response.moment;
    }
    const LoadRows for_i(LoadColumns(response.force, turn_i));
    const LoadRows for_j(LoadColumns(response.force, turn_j));
    if (out != nullptr) {
      for (std::size_t k = 0; k < kWidth; ++k) {
        out[at[k]] = {};
        for_i.add_to(out[at[k]].for_i, k);
        for_j.add_to(out[at[k]].for_j, k);
      }
      return;
    }
    for (std::size_t k = 0; k < kWidth; ++k) {
      for_i.add_to(scene.load(pair.i[k]), k);
      for_j.subtract_from(scene.load(pair.j[k]), k);
    }
  }

  /// Contacts at[0], at[1], ... of the table, one per lane; their losses go to a partial sum.
  template <class Places>
  void pairs(PairTable<Pair, typename Law::template Memory<Dim>>& table, Places at,
             std::size_t partial, PairLoad<Dim, needs>* out) {
    const PairOfLanes pair = gather(table, at);
    auto [touching, touch] = touch_of(pair.body_i, pair.body_j);
    if (!any(touching)) {
      write_memory(table, at, Memory{});
      if (out != nullptr) {
        for (std::size_t k = 0; k < kWidth; ++k) out[at[k]] = {};
      }
      return;
    }
    // A lane apart that seems to slide or roll would make all take the long way through the law.
    for (int d = 0; d < Dim; ++d) touch.slip[d] = only_if(touching, touch.slip[d]);
    if constexpr (needs.rolling) {
      for (Real& component : touch.relative_spin) component = only_if(touching, component);
    }
    Memory memory = read_memory(table, at);
    const Response<Dim, Real> response = respond(
        touch, touching, pair.i, [&](std::size_t k) { return scene.material(pair.j[k]); }, memory);
    write_memory(table, at, memory);
    const Real limit = scene.largest_overlap * smaller(pair.body_i.radius, pair.body_j.radius);
    note(response, touching, Real(touch.overlap - limit), partial);
    scatter(pair, touch, response, at, out);
  }

  /// Contacts of a grain and a wall: the entries first, first + 1, ... of the table, one per lane.
  void walls(PairTable<WallPair, typename Law::template Memory<Dim>>& table, std::size_t first,
             std::size_t partial, WallLoad<Dim>* wall_loads) {
    Slots i;
    std::array<const Wall<Dim>*, kWidth> wall;
    Real distance, mass;
    Vec<Dim, Real> normal, wall_velocity;
    SpinVec<Dim, Real> wall_spin = SpinVec<Dim, Real>::Zero();
    for (std::size_t k = 0; k < kWidth; ++k) {
      const auto [slot, w, piece] = table.pairs()[first + k];
      const int at = static_cast<int>(k);
      i[k] = slot;
      wall[k] = &scene.walls[w];
      const Vec<Dim> centre = scene.grains[slot].position();
      const auto foot = wall[k]->joined ? contact_foot<Dim>(scene.walls, table.pairs(), first + k,
                                                            centre, scene.grains[slot].radius())
                                        : wall[k]->foot(piece, centre);
      const Vec<Dim> surface_velocity =
          wall[k]->uneven ? wall[k]->velocity_at(centre - foot.distance * foot.normal, foot.normal)
                          : wall[k]->velocity;
      set_lane(distance, at, foot.distance);
      set_lane(mass, at, scene.load(slot).at[Load::kMass]);
      for (int d = 0; d < Dim; ++d) {
        set_lane(normal[d], at, foot.normal[d]);
        set_lane(wall_velocity[d], at, surface_velocity[d]);
      }
      if (!wall[k]->uneven) continue;
      for (int d = 0; d < kSpinDim<Dim>; ++d) set_lane(wall_spin[d], at, wall[k]->spin[d]);
    }
    const auto body = read_bodies<Real>(scene.grains, i);
    const auto [touching, touch] =
        touch_of_wall(body, mass, distance, normal, wall_velocity, wall_spin);
    if (!any(touching)) return write_memory(table, InRow{first}, Memory{});

    Memory memory = read_memory(table, InRow{first});
    const auto wall_material = [&](std::size_t k) {
      return static_cast<std::size_t>(wall[k]->material);
    };
    const Response<Dim, Real> response = respond(touch, touching, i, wall_material, memory);
    write_memory(table, InRow{first}, memory);
    note(response, touching, Real(touch.overlap - scene.largest_overlap * body.radius), partial);

    SpinVec<Dim, Real> turn;
    if constexpr (needs.spin) {
      turn = -distance * torque<Real>(normal, response.force);
    }
    if constexpr (needs.rolling) turn += response.moment;
    const LoadRows push(LoadColumns(response.force, turn));
    for (std::size_t k = 0; k < kWidth; ++k) {
      push.add_to(scene.load(i[k]), k);
      const auto at = static_cast<int>(k);
      const auto in_lane = [&]<int N>(const Eigen::Matrix<Real, N, 1>& of_all) {
        return Eigen::Matrix<double, N, 1>::NullaryExpr(
            [&, at](Eigen::Index d) { return lane(of_all[d], at); });
      };
      WallLoad<Dim>& load = wall_loads[table.pairs()[first + k].wall];
      load.force -= in_lane(response.force);
      if (!wall[k]->uneven) continue;
      const Vec<Dim> force = in_lane(response.force), n = in_lane(normal);
      const Vec<Dim> foot = scene.grains[i[k]].position() - lane(distance, at) * n;
      if (wall[k]->turns()) load.torque -= torque<double>(Vec<Dim>(foot - wall[k]->pivot), force);
      if constexpr (needs.rolling) load.torque -= in_lane(response.moment);
      if (wall[k]->runs()) load.power -= force.dot(wall[k]->belt_along(n));
    }
  }
};

/// The contacts 0 to count - 1 of a table through `contact(sweep, first, partial)`: as many at once
/// as there are lanes, the rest one by one.
template <int Dim, class Law, class Real, bool kOneLaw, class Contact>
Tally sweep_over(const ContactScene<Dim, Law>& scene, std::size_t count, Contact&& contact) {
  Sums sums;
  std::size_t first = 0;
  Sweep<Dim, Law, Real, kOneLaw> wide(scene);
  for (; first + kLanes<Real> <= count; first += kLanes<Real>) {
    contact(wide, first, first % Sums::kPartialSums / kLanes<Real>);
  }
  sums.add(wide);
  if (first < count) {
    Sweep<Dim, Law, double, kOneLaw> single(scene);
    for (; first < count; ++first) contact(single, first, first % Sums::kPartialSums);
    sums.add(single);
  }
  return sums.total();
}

/// The contacts of a table of which few touch: these are picked, stretch by stretch while their
/// grains are at hand, and fill the lanes.
template <int Dim, class Law, class Real, bool kOneLaw>
Tally sweep_picked(const ContactScene<Dim, Law>& scene,
                   PairTable<Pair, typename Law::template Memory<Dim>>& table,
                   PairLoad<Dim, Law::needs>* out) {
  // Pairs that are searched before the law is applied to what was found among them. It changes no
  // result and was not tuned: the records of a stretch lie in the first-level cache at twice the
  // number as well, and at half of it the lanes are left as rarely.
  constexpr std::size_t kStretch = 256, kWidth = kLanes<Real>;
  Sweep<Dim, Law, Real, kOneLaw> wide(scene);
  Sweep<Dim, Law, double, kOneLaw> single(scene);
  std::array<std::size_t, kStretch + kWidth> picked;
  std::size_t* const front = picked.data();
  std::size_t* back = front;
  std::size_t rank = 0;  // among those that touch
  for (std::size_t next = 0, end = table.size(); next < end;) {
    const std::size_t stop = std::min(end, next + kStretch);
    for (; next + kWidth <= stop; next += kWidth) back = wide.pick(table, next, out, back);
    for (; next < stop; ++next) back = single.pick(table, next, out, back);
    std::size_t* at = front;
    for (; at + kWidth <= back; at += kWidth, rank += kWidth) {
      wide.pairs(table, Picked{at}, rank % Sums::kPartialSums / kWidth, out);
    }
    back = std::copy(at, back, front);
  }
  for (const std::size_t* at = front; at != back; ++at, ++rank) {
    single.pairs(table, Picked{at}, rank % Sums::kPartialSums, out);
  }
  Sums sums;
  sums.add(wide);
  sums.add(single);
  return sums.total();
}

}  // namespace lagrain::detail
