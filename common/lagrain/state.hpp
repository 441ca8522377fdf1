// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What has to be kept of a simulation for it to go on as if nothing had happened. Who has such a
/// part names its numbers once, in a function `persist(StateVisitor&)` that both keeps them and
/// takes them back.

#include <lagrain/check.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace lagrain {

/// Rows of numbers, all of one kind.
template <class Number>
struct NumberTable {
  std::size_t columns = 1;      ///< numbers in a row
  std::vector<Number> numbers;  ///< row by row
  /// How many rows there are.
  std::size_t rows() const { return numbers.size() / columns; }
  bool operator==(const NumberTable&) const = default;
};

/// Tables and texts by name. A name is a path: "grains/radius".
class State {
 public:
  using Value =
      std::variant<NumberTable<double>, NumberTable<std::int64_t>, std::string>;  ///< of a name
  /// All there is, in the order of the names.
  const std::map<std::string, Value>& values() const { return values_; }
  /// Gives a name its value.
  void set(const std::string& name, Value value) { values_[name] = std::move(value); }
  /// @throws SceneError if the name has none, or one of another kind
  template <class T>
  const T& get(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) throw SceneError("it has no " + name);
    const T* value = std::get_if<T>(&found->second);
    if (value == nullptr) throw SceneError("its " + name + " is of another kind");
    return *value;
  }

 private:
  std::map<std::string, Value> values_;
};

/// Visits what has to be kept, thing by thing, and either keeps it in a state or takes it back.
class StateVisitor {
 public:
  /// A visitor that keeps what it sees in a state.
  static StateVisitor keeping(State& state) { return StateVisitor(&state, nullptr); }
  /// A visitor that gives everything it sees the value that it has in a state.
  static StateVisitor restoring(const State& state) { return StateVisitor(nullptr, &state); }

  /// Whether values change.
  bool restores() const { return from_ != nullptr; }
  /// The same visitor for the parts of something: their names begin with `name` and a slash.
  StateVisitor in(const std::string& name) const {
    StateVisitor inner = *this;
    inner.path_ += name + "/";
    return inner;
  }

  /// A number, a list of numbers, a matrix (a row in the state is a column of it, so that each row
  /// is of one grain), or a text.
  /// @throws SceneError if it is to be restored, and the state has no value for it that fits
  template <class T>
  void operator()(const std::string& name, T& value) {
    if constexpr (std::is_same_v<T, std::string>) {
      exchange_text(name, value);
    } else if constexpr (std::is_arithmetic_v<T>) {
      std::vector<T> list{value};
      exchange_numbers(name, 1, list);
      if (list.size() != 1) refuse(name, "1 number");
      value = list.front();
    } else if constexpr (requires { value.reserve(0); }) {
      exchange_numbers(name, 1, value);
    } else {
      exchange_matrix(name, value);
    }
  }

 private:
  StateVisitor(State* to, const State* from) : to_(to), from_(from) {}

  template <class T>
  using Stored = std::conditional_t<std::floating_point<T>, double, std::int64_t>;

  [[noreturn]] void refuse(const std::string& name, const std::string& expected) const {
    throw SceneError("its " + path_ + name + " is not " + expected);
  }
  void exchange_text(const std::string& name, std::string& text) {
    if (to_ != nullptr) to_->set(path_ + name, text);
    if (from_ != nullptr) text = from_->get<std::string>(path_ + name);
  }
  template <class T>
  void exchange_numbers(const std::string& name, std::size_t columns, std::vector<T>& list) {
    using Numbers = NumberTable<Stored<T>>;
    if (to_ != nullptr) to_->set(path_ + name, Numbers{columns, {list.begin(), list.end()}});
    if (from_ == nullptr) return;
    const Numbers& table = from_->get<Numbers>(path_ + name);
    if (table.columns != columns) refuse(name, std::to_string(columns) + " numbers wide");
    list.assign(table.numbers.begin(), table.numbers.end());
  }
  template <class Matrix>
  void exchange_matrix(const std::string& name, Matrix& matrix) {
    constexpr bool fixed = Matrix::SizeAtCompileTime != Eigen::Dynamic;
    constexpr bool one_row = !fixed && Matrix::ColsAtCompileTime == 1;  // a list
    const auto columns =
        one_row ? std::size_t{1} : static_cast<std::size_t>(fixed ? matrix.size() : matrix.rows());
    std::vector<double> list(matrix.data(), matrix.data() + matrix.size());
    exchange_numbers(name, columns, list);
    if (from_ == nullptr) return;
    const auto rows = static_cast<Eigen::Index>(list.size() / columns);
    if constexpr (fixed) {
      if (rows != 1) refuse(name, "1 row");
    } else if constexpr (one_row) {
      matrix.resize(rows);
    } else {
      matrix.resize(Eigen::NoChange, rows);
    }
    std::copy(list.begin(), list.end(), matrix.data());
  }

  State* to_;
  const State* from_;
  std::string path_;
};

}  // namespace lagrain
