// SPDX-License-Identifier: GPL-3.0-or-later
#include "together.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace lagrain::figures {

void do_together(std::size_t count,
                 const std::function<void(std::size_t k, const Watch& watch)>& piece,
                 const FigureOptions& options, const std::string& doing) {
  std::vector<std::atomic<double>> done(count);
  std::atomic<bool> stop = false;
  std::atomic<std::size_t> next = 0, finished = 0;
  std::mutex failure_guard;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t k = next++; k < count; k = next++) {
      try {
        piece(k, [&](double fraction) {
          done[k] = fraction;
          return !stop;
        });
      } catch (...) {
        const std::lock_guard lock(failure_guard);
        if (!failure) failure = std::current_exception();
        stop = true;
      }
      ++finished;
    }
  };
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::jthread> threads;
  for (std::size_t k = 0; k < std::min(cores, count); ++k) threads.emplace_back(work);
  while (finished < count) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (options.stop()) stop = true;
    double sum = 0;
    for (const std::atomic<double>& one : done) sum += one;
    options.progress(sum / static_cast<double>(count), std::to_string(count) + " " + doing);
  }
  threads.clear();
  if (failure) std::rethrow_exception(failure);
  if (stop) throw Interrupted();
}

}  // namespace lagrain::figures
