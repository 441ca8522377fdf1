// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/threads.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace lagrain {

// ---- How many threads pay -----------------------------------------------------------------------

void TeamSize::note(double seconds) {
  seconds_ += seconds;
  since_trial_ += seconds;
  if (++rounds_ < kLeastRounds || seconds_ < kWindow || most_ == 1) return;
  const double cost = seconds_ / rounds_;
  rounds_ = 0;
  seconds_ = 0;
  if (trial_ == 0) {
    cost_ = cost;
    if (cost > kOften * usual_cost_) patience_ = kLeastPatience;
    if (since_trial_ >= patience_) trial_ = next_trial();
    return;
  }
  if (cost < (trial_ < size_ ? kFewer : kMore) * cost_) {
    size_ = trial_;
    cost_ = cost;
    patience_ = kLeastPatience;
  } else {
    patience_ = std::min(2 * patience_, kMostPatience);
  }
  usual_cost_ = cost_;
  trial_ = 0;
  since_trial_ = 0;
}

int TeamSize::next_trial() {
  up_ = size_ == 1 || (size_ < most_ && !up_);
  return up_ ? std::min(2 * size_, most_) : (size_ + 1) / 2;
}

// ---- The team -----------------------------------------------------------------------------------

namespace {

/// Longer than the work between two rounds of a usual step, and shorter than the time that a system
/// gives a program before it lets another one have the core. 10,192 spheres on two idle cores took
/// 1.91 s with it and 2.02 s with a tenth of it, as a thread that sleeps wakes up late (medians of
/// 21 runs); the processor time was 1.26 and 1.17 times that of one thread.
constexpr auto kLook = std::chrono::microseconds(300);

/// Tells the processor that we are waiting.
void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

/// Waits until an atomic number is no more what it was.
template <class T>
void wait_while(const std::atomic<T>& number, T old) {
  constexpr int kLooks = 64;  // between two looks at the clock, which take as long as one of these
  const auto end = std::chrono::steady_clock::now() + kLook;
  do {
    for (int k = 0; k < kLooks; ++k) {
      if (number.load() != old) return;
      pause();
    }
  } while (std::chrono::steady_clock::now() < end);
  number.wait(old);
}

}  // namespace

class ThreadTeam::Crew {
 public:
  explicit Crew(int threads) : size_(threads), seats_(static_cast<std::size_t>(threads)) {
    for (std::size_t me = 1; me < seats_.size(); ++me) {
      seats_[me].helper = std::thread([this, me] { help(me); });
    }
  }
  ~Crew() {
    goes_home_ = true;
    for (Seat& seat : seats_) {
      call(seat);
      if (seat.helper.joinable()) seat.helper.join();
    }
  }
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  int most() const { return static_cast<int>(seats_.size()); }
  int size() const { return static_cast<int>(called_); }

  void share(std::size_t count, Call call_item, const void* what) {
    const auto begin = std::chrono::steady_clock::now();
    call_item_ = call_item;
    work_ = what;
    called_ = std::min(static_cast<std::size_t>(size_.now()), count);
    for (std::size_t k = 0; k < called_; ++k) {
      seats_[k].next = count * k / called_;
      seats_[k].end = count * (k + 1) / called_;
    }
    open_ = true;
    for (std::size_t k = 1; k < called_; ++k) call(seats_[k]);
    work(0);
    // From here on nobody begins. This store and the loads that follow, and the two in help(), are
    // in one order for all threads: either the helper sees that the round is over, or we see that
    // the helper is inside.
    open_ = false;
    while (const int inside = inside_) wait_while(inside_, inside);
    size_.note(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  }

 private:
  /// A thread's own, apart from that of the others in memory, so that they do not wait for it.
  struct alignas(64) Seat {
    std::atomic<std::size_t> next = 0;  ///< of its part of the round
    std::size_t end = 0;
    std::atomic<std::uint32_t> calls = 0;
    std::thread helper;
  };

  static void call(Seat& seat) {
    ++seat.calls;
    seat.calls.notify_one();
  }

  void help(std::size_t me) {
    for (std::uint32_t heard = 0;;) {
      wait_while(seats_[me].calls, heard);
      heard = seats_[me].calls;
      if (goes_home_) return;
      ++inside_;
      if (open_ && me < called_) work(me);
      if (--inside_ == 0) inside_.notify_one();
    }
  }

  /// First one's own part, then what is left of the others'.
  void work(std::size_t me) {
    try {
      for (std::size_t k = 0; k < called_; ++k) {
        Seat& seat = seats_[(me + k) % called_];
        for (std::size_t item = seat.next++; item < seat.end; item = seat.next++) {
          call_item_(work_, item, me);
        }
      }
    } catch (...) {
      const std::lock_guard lock(throwing_);
      if (!thrown_) thrown_ = std::current_exception();
    }
  }

  TeamSize size_;
  // A round. Only the caller writes them, while it is closed and nobody is inside.
  Call call_item_ = nullptr;
  const void* work_ = nullptr;
  std::size_t called_ = 1;  // so many seats
  std::vector<Seat> seats_;

  std::atomic<bool> open_ = false;  // helpers may begin
  std::atomic<bool> goes_home_ = false;
  std::atomic<int> inside_ = 0;  // helpers that may have begun
  std::mutex throwing_;
  std::exception_ptr thrown_;
};

ThreadTeam::ThreadTeam(int threads) {
  if (threads > 1) crew_ = std::make_unique<Crew>(threads);
}
ThreadTeam::~ThreadTeam() = default;
ThreadTeam::ThreadTeam(const ThreadTeam& other)
    : ThreadTeam(other.crew_ ? other.crew_->most() : 1) {}
ThreadTeam& ThreadTeam::operator=(const ThreadTeam& other) { return *this = ThreadTeam(other); }
ThreadTeam::ThreadTeam(ThreadTeam&& other) noexcept = default;
ThreadTeam& ThreadTeam::operator=(ThreadTeam&& other) noexcept = default;

int ThreadTeam::size() const { return crew_ ? crew_->size() : 1; }

void ThreadTeam::share_calls(std::size_t count, Call call, const void* work) {
  if (crew_ && count > 1) {
    crew_->share(count, call, work);
  } else {
    for (std::size_t item = 0; item < count; ++item) call(work, item, 0);
  }
}

}  // namespace lagrain
