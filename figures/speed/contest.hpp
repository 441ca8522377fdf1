// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The competition of all contenders on a scene, or on several scenes at once.

#include "turns.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lagrain::bench {

/// One scene and all who take part in it.
template <int Dim>
struct Match {
  struct Entry {
    std::string name;
    /// Takes the steps before those that are measured. It reads the match, which does not move.
    std::function<std::unique_ptr<TurnTaker<Dim>>(bool careful)> start;
    std::unique_ptr<TurnTaker<Dim>> running;
    std::vector<std::vector<Phase>> phases;  // by round
    Columns<Dim> position;                   // at the end of the first [m]
    bool out = false;
  };
  Bed<Dim> bed;
  Plan plan;
  SceneSpeed scene;
  std::vector<Entry> entries;
};

/// Runs contenders against each other and keeps what they have shown.
class Contest {
 public:
  /// @param lammps  the program, if there is one; files of it go to folders below options.out
  Contest(const FigureOptions& options, const std::optional<std::filesystem::path>& lammps);
  Contest(const Contest&) = delete;
  Contest& operator=(const Contest&) = delete;

  /// Tells which share of all scenes is done.
  void set_progress(double fraction) { fraction_ = fraction; }
  /// Tells what is being done, for whoever waits.
  void say(const std::string& doing) { doing_ = doing; }
  /// Shows the progress as well.
  const StopCheck& check_stop() const { return check_stop_; }

  /// A scene and those who are to run it.
  /// @param parameter  what the group varies: grains, ratio of sizes, speed
  template <int Dim>
  std::unique_ptr<Match<Dim>> prepare(const std::string& group, const std::string& what,
                                      const Bed<Dim>& bed, const Plan& plan, double parameter);

  /// Runs scenes round by round, and in each round turn by turn, through all scenes and contenders:
  /// what is compared shares the machine's moods, which may last a second.
  /// @throws Interrupted, SimulationError
  template <int Dim>
  void compete(const std::vector<std::unique_ptr<Match<Dim>>>& matches);

  const SpeedResults& results() const { return results_; }

 private:
  template <int Dim, class F>
  void unless_it_fails(Match<Dim>& match, std::size_t k, F&& f);

  const FigureOptions& options_;
  std::optional<std::filesystem::path> lammps_;
  StopCheck check_stop_;
  std::string doing_;
  double fraction_ = 0;
  SpeedResults results_;
};

}  // namespace lagrain::bench
