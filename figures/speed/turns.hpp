// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How a contender is measured: it takes its steps in turns with the others, so that a busy machine
/// slows all of them alike, and then tells what they have cost and how good they were.

#include "beds.hpp"
#include "speed.hpp"

#include <string>
#include <vector>

namespace lagrain::bench {

/// All contenders run once in each round; the median of three is deaf to one disturbance.
inline constexpr int kRounds = 3;
/// The measured steps of a round are taken in so many turns: a machine's moods last about a second,
/// and a turn is shorter.
inline constexpr int kTurns = 12;

/// How many steps, and who takes part.
struct Plan {
  int warm_up = 0;
  int steps = 0;  ///< a multiple of kTurns
  int rounds = kRounds;
  bool oracle = true;
  bool rebuilt = true;
  bool lammps = true;
  bool multi = false;  ///< LAMMPS with bins by size as well
  bool bin = true;     ///< LAMMPS with equal bins
};

/// What one run of a contender gives.
template <int Dim>
struct Sample {
  double cpu = 0;  ///< [s], of the measured steps
  std::vector<Phase> phases;
  RunErrors errors;
  Columns<Dim> position;  ///< by id, at the end [m]
};

/// Enters the contacts, overlaps, load and kinetic energy of a state, by a search of its own.
template <int Dim>
void examine(const Bed<Dim>& bed, const Columns<Dim>& x, const Columns<Dim>& v, RunErrors& errors);

/// Turns the time of each phase into processor time per grain and step [ns]. A phase of nanoseconds
/// cannot ask for the processor's time, so its share of the wall clock is taken.
/// @param spent        wall-clock time of each phase [ns]
/// @param wall         wall-clock time of all steps [s]
/// @param cpu          processor time of all steps [s]
/// @param grain_steps  how many grains took how many steps
std::vector<Phase> per_grain_step(const std::vector<Phase>& spent, double wall, double cpu,
                                  double grain_steps);

/// The number of grains times the measured steps of a round.
template <int Dim>
double grain_steps(const Bed<Dim>& bed, const Plan& plan) {
  return static_cast<double>(bed.count()) * plan.steps;
}

/// A contender on its way through the measured steps, in turns with others.
template <int Dim>
class TurnTaker {
 public:
  virtual ~TurnTaker() = default;
  virtual void take_turn(int turn) = 0;
  /// @pre all turns are taken
  virtual Sample<Dim> sample() = 0;
};

}  // namespace lagrain::bench
