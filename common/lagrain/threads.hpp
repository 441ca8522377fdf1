// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `share_among_threads` divides work among threads.

#include <cstddef>

namespace lagrain {

/// Calls f(item, thread) for every item in [0, count); each thread takes a run of items, the same
/// every time. One thread alone does without OpenMP, whose team of one takes a microsecond to
/// call together.
template <class F>
void share_among_threads(std::size_t count, int threads, F&& f) {
  const auto n = static_cast<std::size_t>(threads);
  const auto share = [&](std::size_t thread) {
    const std::size_t end = count * (thread + 1) / n;
    for (std::size_t item = count * thread / n; item < end; ++item) f(item, thread);
  };
  if (threads == 1) {
    share(0);
    return;
  }
#pragma omp parallel for schedule(static, 1) num_threads(threads)
  for (std::size_t thread = 0; thread < n; ++thread) share(thread);
}

}  // namespace lagrain
