#pragma once
/// @file
/// Contracts and exceptions. The library throws; only the program prints and exits.

#include <stdexcept>
#include <string>

namespace lagrain {

/// The caller broke a documented precondition.
struct ContractError : std::logic_error {
  using std::logic_error::logic_error;
};

/// The user's input is wrong: a scene, a file, a flag. The message is one sentence that names the
/// place, the value and what was expected.
struct SceneError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The simulated physics went wrong: NaN, an overlap out of bounds, an unstable time step.
struct SimulationError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

namespace detail {
[[noreturn]] inline void contract_failed(const char* condition, const std::string& message) {
  throw ContractError(message + " (expected " + condition + ")");
}
}  // namespace detail

}  // namespace lagrain

/// Precondition of a public function: on unless LAGRAIN_NO_CONTRACTS is defined.
#ifdef LAGRAIN_NO_CONTRACTS
#define LAGRAIN_EXPECTS(condition, message) static_cast<void>(0)
#else
#define LAGRAIN_EXPECTS(condition, message) \
  ((condition) ? static_cast<void>(0) : ::lagrain::detail::contract_failed(#condition, message))
#endif
