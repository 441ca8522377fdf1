// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `ThreadTeam` divides work among threads: among as many as pay, which `TeamSize` finds out.

#include <cstddef>
#include <memory>

namespace lagrain {

/// How many threads share the rounds of a loop, each of which takes about as long as the one
/// before. Two threads on two cores that others use as well may take longer than one: a thread that
/// has to wait for a core keeps the rest of the team waiting. So the team tries half or twice as
/// many threads now and then, and goes on with what takes less time.
class TeamSize {
 public:
  /// Begins with the most.
  explicit TeamSize(int most) : most_(most), size_(most) {}

  int now() const { return trial_ > 0 ? trial_ : size_; }  ///< threads for the next round
  /// Learns how long a round of now() threads took [s].
  void note(double seconds);

 private:
  int next_trial();

  int most_;
  int size_;
  int trial_ = 0;  // of so many; 0: there is none now
  bool up_ = false;
  // Of the window.
  int rounds_ = 0;
  double seconds_ = 0;
  double cost_ = 0;        // of a round, in the last window without a trial [s]
  double usual_cost_ = 0;  // as it was at the last trial [s]
  double patience_ = kLeastPatience;
  double since_trial_ = 0;  // [s]

  // The next numbers change no result, and were not tuned. On an idle machine trials take 2 % of
  // the first second and 0.3 % of twenty; with twice the window 4 % and 0.6 % (test_threads.cpp).
  static constexpr double kWindow = 0.02;        // of rounds whose mean counts [s]
  static constexpr int kLeastRounds = 8;         // in a window
  static constexpr double kLeastPatience = 0.2;  // from one trial to the next [s]
  static constexpr double kMostPatience = 10;    // the same, after many that changed nothing [s]
  static constexpr double kOften = 1.3;          // a round so much dearer: try soon again
  static constexpr double kFewer = 1.05;         // fewer threads may take so much longer
  static constexpr double kMore = 0.9;           // more threads have to take less than this
};

/// Threads that share rounds of work. Each has its own part of a round, the same every time, so
/// that its data stay in its core's cache; who is done takes from the others. Nobody waits for one
/// that has not begun. Who waits looks for a moment and then sleeps, so that others get the core.
class ThreadTeam {
 public:
  /// @param threads  at most so many; one does without any machinery
  explicit ThreadTeam(int threads = 1);
  ~ThreadTeam();
  /// A copy is as large, with threads of its own.
  /// @{
  ThreadTeam(const ThreadTeam& other);
  ThreadTeam& operator=(const ThreadTeam& other);
  /// @}
  /// Who is moved from can only be assigned to, or end.
  /// @{
  ThreadTeam(ThreadTeam&& other) noexcept;
  ThreadTeam& operator=(ThreadTeam&& other) noexcept;
  /// @}

  /// Threads that the last round was shared by.
  int size() const;

  /// Calls f(item, thread) once for every item in [0, count), with the caller as thread 0, and
  /// comes back when all are done. What f throws is thrown here.
  template <class F>
  void share(std::size_t count, const F& f) {
    // Through a pointer, so that the compiler has one copy of f to optimise, not two.
    share_calls(
        count,
        [](const void* work, std::size_t item, std::size_t thread) {
          (*static_cast<const F*>(work))(item, thread);
        },
        &f);
  }

 private:
  class Crew;
  using Call = void (*)(const void* work, std::size_t item, std::size_t thread);
  void share_calls(std::size_t count, Call call, const void* work);

  std::unique_ptr<Crew> crew_;
};

}  // namespace lagrain
