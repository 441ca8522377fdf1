// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// A bed in LAMMPS: its data file and its input, a run of the program, and what it reports.
///
/// The law is pair_style gran/hooke/history with walls of the same style. Two things differ from
/// ours: its normal dashpot may attract at the end of a contact, and its damping grows with the
/// effective mass itself where ours grows with its root. The dashpots are therefore set alike for
/// two grains of median mass, and for such a grain on a wall.

#include "beds.hpp"

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::bench {

/// How long LAMMPS runs and how it looks for neighbours.
struct LammpsPlan {
  int warm_up = 0;     ///< steps that are not measured
  int steps = 0;       ///< steps that are, in so many
  int turns = 1;       ///< equal parts
  bool multi = false;  ///< neighbour bins by atom type: needs sizes sorted into types, as we do
};

/// Distance by which its lists reach beyond contact, of the smallest radius [-].
inline constexpr double kLammpsSkin = 0.2;

/// What LAMMPS reports on the measured steps, and where it leaves the grains.
template <int Dim>
struct LammpsReport {
  double wall_seconds = 0;                             ///< its "Loop time" [s]
  double cpu_seconds = 0;                              ///< of that, its share of the processor [s]
  std::vector<std::pair<std::string, double>> phases;  ///< its breakdown [s]
  std::int64_t neighbours = 0;                         ///< pairs in its list
  std::int64_t builds = 0;                             ///< of the list
  std::int64_t dangerous = 0;                          ///< builds that may have come too late
  Columns<Dim> position;                               ///< by id [m]
  Columns<Dim> velocity;                               ///< by id [m/s]
};

/// The program `lmp` (or what LAGRAIN_LAMMPS names), if there is one.
std::optional<std::filesystem::path> find_lammps();

/// What the program calls itself: "29 Sep 2021 - Update 2".
std::string lammps_version(const std::filesystem::path& program);

/// Type of every atom: 1, or 2 for grains of more than twice the median radius.
template <int Dim>
std::vector<int> lammps_types(const Bed<Dim>& bed);

/// The grains as a data file of atom style sphere; densities are such that masses agree also for
/// discs, which LAMMPS weighs as spheres.
template <int Dim>
std::string lammps_data(const Bed<Dim>& bed);

/// The input that goes with `data.lammps`.
/// @pre walls are half-spaces along the axes, at rest or all shaken alike from their lowest place
template <int Dim>
std::string lammps_input(const Bed<Dim>& bed, const LammpsPlan& plan);

/// LAMMPS on one core in a folder, where data.lammps and in.lammps stay for the reader. It takes
/// turns with others: between them it waits.
template <int Dim>
class LammpsRun {
 public:
  /// Returns when the steps that are not measured are done.
  /// @throws SimulationError if LAMMPS fails, with its own words; so do the others
  LammpsRun(const std::filesystem::path& program, std::filesystem::path folder, const Bed<Dim>& bed,
            const LammpsPlan& plan);
  LammpsRun(const LammpsRun&) = delete;
  LammpsRun& operator=(const LammpsRun&) = delete;
  ~LammpsRun();

  /// The next part of the measured steps.
  void take_turn();
  /// @pre all turns are taken
  LammpsReport<Dim> finish();

 private:
  /// A file descriptor that is closed with its owner.
  struct Descriptor {
    int number = -1;
    ~Descriptor();
  };

  void go_on();
  bool pauses();
  void wait_for_pause();
  int wait_for_end();

  std::filesystem::path folder_;
  int count_;
  int turns_;
  Descriptor line_;    // to the process
  pid_t process_ = 0;  // 0 when it has ended
};

}  // namespace lagrain::bench
