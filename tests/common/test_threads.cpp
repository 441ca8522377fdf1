// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Threads that share work, and how many of them do. What a machine would take is computed here, so
/// that no test depends on how busy this one is.

#include <lagrain/threads.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

using namespace lagrain;

namespace {

/// Rounds of a team on a machine that is computed.
struct Trace {
  double seconds = 0;
  double processor_seconds = 0;
  std::vector<int> sizes;  // of each round
};

/// @param cost  seconds that a round takes so many threads at a time [s]
Trace rounds(TeamSize& size, double until, const std::function<double(int, double)>& cost) {
  Trace trace;
  while (trace.seconds < until) {
    const int threads = size.now();
    const double seconds = cost(threads, trace.seconds);
    trace.sizes.push_back(threads);
    trace.seconds += seconds;
    trace.processor_seconds += seconds * threads;
    size.note(seconds);
  }
  return trace;
}

double share_of(const Trace& trace, int threads) {
  return static_cast<double>(std::count(trace.sizes.begin(), trace.sizes.end(), threads)) /
         static_cast<double>(trace.sizes.size());
}

constexpr double kRound = 1e-3;  // of one thread [s]
double idle(int threads, double) { return kRound / threads; }
/// One core is taken by another program: who shares it waits for it.
double busy(int threads, double) { return threads == 1 ? kRound : 3 * kRound; }

}  // namespace

TEST_SUITE("team size") {
  TEST_CASE("on an idle machine all threads stay, and trials cost less than two percent") {
    TeamSize size(2);
    const Trace trace = rounds(size, 20, idle);
    CHECK(size.now() == 2);
    CHECK(share_of(trace, 2) > 0.99);
    CHECK(trace.seconds / static_cast<double>(trace.sizes.size()) < 1.02 * kRound / 2);
  }

  TEST_CASE("beside another program one thread is left, and a round takes little longer") {
    TeamSize size(2);
    const Trace trace = rounds(size, 20, busy);
    CHECK(share_of(trace, 1) > 0.97);
    const auto count = static_cast<double>(trace.sizes.size());
    CHECK(trace.seconds / count < 1.05 * kRound);
    CHECK(trace.processor_seconds / count < 1.1 * kRound);
  }

  TEST_CASE("threads are let go when another program comes, and taken back when it has gone") {
    TeamSize size(2);
    const auto cost = [](int threads, double t) {
      return t > 5 && t < 10 ? busy(threads, t) : idle(threads, t);
    };
    rounds(size, 5, cost);
    CHECK(size.now() == 2);
    const auto later = [&](double shift) {
      return [&cost, shift](int threads, double t) { return cost(threads, t + shift); };
    };
    const Trace beside = rounds(size, 5, later(5));
    CHECK(share_of(beside, 1) > 0.85);
    rounds(size, 15, later(10));
    CHECK(size.now() == 2);
  }

  TEST_CASE("of many threads so many are used as pay") {
    // The memory serves four: more of them only wait for it.
    for (const int best : {1, 4, 16}) {
      CAPTURE(best);
      TeamSize size(16);
      const auto cost = [best](int threads, double) {
        return kRound * (1.0 / std::min(threads, best) + 0.02 * std::max(0, threads - best));
      };
      const Trace trace = rounds(size, 30, cost);
      CHECK(share_of(trace, best) > 0.9);
    }
  }

  TEST_CASE("a thread more that saves nothing is not used: it costs processor time") {
    TeamSize size(2);
    const Trace trace = rounds(size, 10, [](int, double) { return kRound; });
    CHECK(share_of(trace, 1) > 0.95);
  }

  TEST_CASE("one thread is one thread") {
    TeamSize size(1);
    const Trace trace = rounds(size, 5, idle);
    CHECK(share_of(trace, 1) == 1);
  }

  TEST_CASE("there are never more than the most, nor fewer than one") {
    for (const int most : {2, 3, 5, 12}) {
      TeamSize size(most);
      // What pays changes all the time.
      const Trace trace = rounds(size, 30, [most](int threads, double t) {
        const int best = 1 + static_cast<int>(t) % most;
        return kRound * (1 + std::max(best - threads, threads - best));
      });
      CHECK(*std::min_element(trace.sizes.begin(), trace.sizes.end()) >= 1);
      CHECK(*std::max_element(trace.sizes.begin(), trace.sizes.end()) <= most);
    }
  }
}

TEST_SUITE("thread team") {
  TEST_CASE("every item is done once, by a thread of the team") {
    for (const int threads : {1, 2, 3, 8}) {
      ThreadTeam team(threads);
      for (const std::size_t count : {0, 1, 2, 3, 5, 100, 1000}) {
        CAPTURE(threads);
        CAPTURE(count);
        std::vector<std::atomic<int>> done(count);
        std::atomic<bool> theirs = true;
        team.share(count, [&](std::size_t item, std::size_t thread) {
          ++done[item];
          if (thread >= static_cast<std::size_t>(threads)) theirs = false;
        });
        CHECK(std::all_of(done.begin(), done.end(), [](const auto& n) { return n == 1; }));
        CHECK(theirs);
      }
    }
  }

  TEST_CASE("many short rounds: what a round has written is there when it is over") {
    ThreadTeam team(4);
    std::vector<int> sums(64, 0);  // not atomic: each item is one thread's alone
    constexpr int kRounds = 20000;
    for (int round = 0; round < kRounds; ++round) {
      team.share(1 + static_cast<std::size_t>(round) % sums.size(),
                 [&](std::size_t item, std::size_t) { ++sums[item]; });
    }
    int expected = 0;
    for (int round = 0; round < kRounds; ++round) expected += 1 + round % 64;
    int total = 0;
    for (const int sum : sums) total += sum;
    CHECK(total == expected);
  }

  TEST_CASE("what a thread throws comes to the caller, and the team goes on") {
    ThreadTeam team(3);
    for (int round = 0; round < 50; ++round) {
      CHECK_THROWS_AS(team.share(100,
                                 [](std::size_t item, std::size_t) {
                                   if (item % 40 == 39) throw std::runtime_error("no");
                                 }),
                      std::runtime_error);
      std::atomic<int> done = 0;
      team.share(100, [&](std::size_t, std::size_t) { ++done; });
      CHECK(done == 100);
    }
  }

  TEST_CASE("a team can be moved and copied") {
    ThreadTeam team(2);
    ThreadTeam other = std::move(team);
    ThreadTeam copy = other;
    std::atomic<int> done = 0;
    const auto count = [&](std::size_t, std::size_t) { ++done; };
    other.share(10, count);
    copy.share(10, count);
    other = ThreadTeam(3);
    other.share(10, count);
    copy = other;
    copy.share(10, count);
    CHECK(done == 40);
  }
}
