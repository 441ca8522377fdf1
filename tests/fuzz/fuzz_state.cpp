// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A run goes on from a checkpoint whose numbers were changed: it refuses, or makes a step. (Bytes
/// that were changed are found out by the checksum, and never come so far.)

#include "fuzz/one_line.hpp"
#include "support/scene_text.hpp"

#include <lagrain/checkpoint.hpp>
#include <lagrain/output.hpp>
#include <lagrain/run.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <memory>
#include <variant>

using namespace lagrain;

namespace {

/// Reads numbers off the input; zeros when it is at its end.
class Input {
 public:
  Input(const std::uint8_t* bytes, std::size_t size) : at_(bytes), left_(size) {}
  bool empty() const { return left_ == 0; }
  template <class Number>
  Number take() {
    Number number{};
    const std::size_t size = std::min(sizeof number, left_);
    std::memcpy(&number, at_, size);
    at_ += size;
    left_ -= size;
    return number;
  }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

/// Changes one table: a number, its length or its width.
template <class Number>
void change(NumberTable<Number>& table, Input& input) {
  switch (input.take<std::uint8_t>() % 4) {
    case 0:
      table.numbers.resize(input.take<std::uint8_t>() * table.columns);
      return;
    case 1:
      table.columns = 1 + input.take<std::uint8_t>() % 8;
      table.numbers.resize(table.numbers.size() / table.columns * table.columns);
      return;
    default: {
      if (table.numbers.empty()) return;
      const std::size_t at = input.take<std::uint16_t>() % table.numbers.size();
      // Small numbers are what lists point with.
      table.numbers[at] = input.take<std::uint8_t>() % 2 == 0
                              ? static_cast<Number>(input.take<std::int8_t>())
                              : input.take<Number>();
    }
  }
}

/// Grains that fall into a corner, with friction.
template <int Dim>
std::unique_ptr<Run<Dim>> heap() {
  static const Scene<Dim> scene = parse_scene<Dim>(test::in_space<Dim>(test::kHeap), "s.toml");
  return make_run(scene, 1);
}

/// Their state when some of them touch.
template <int Dim>
const State& example() {
  static const State state = [] {
    const auto run = heap<Dim>();
    run->step(run->steps_planned() / 10);
    State kept;
    run->persist(StateVisitor::keeping(kept).in("run"));
    return kept;
  }();
  return state;
}

template <int Dim>
void go_on(Input input) {
  State state = example<Dim>();
  while (!input.empty()) {
    const std::size_t which = input.take<std::uint8_t>() % state.values().size();
    const auto& [name, before] = *std::next(state.values().begin(), static_cast<int>(which));
    State::Value value = before;
    std::visit(
        [&](auto& v) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(v)>, std::string>) change(v, input);
        },
        value);
    state.set(std::string(name), std::move(value));
  }
  const auto run = heap<Dim>();
  try {
    test::refuses_in_one_line([&] {
      run->persist(StateVisitor::restoring(state).in("run"));
      run->step(2);
    });
  } catch (const SimulationError&) {
    // Grains at other places may overlap too much.
  }
}

}  // namespace

// libFuzzer knows it by this name.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  go_on<2>({bytes, size});
  go_on<3>({bytes, size});
  return 0;
}
