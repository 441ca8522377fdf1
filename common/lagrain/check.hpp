// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Contracts and exceptions. The library throws; only the program prints and exits.

#include <stdexcept>
#include <string>
#include <vector>

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

/// What is kept because it is faster to keep than to find again is wrong: lagrain has a bug.
struct AuditError : std::logic_error {
  using std::logic_error::logic_error;
};

/// Whether this build audits, after every update, what is kept because that is faster (the CMake
/// option LAGRAIN_AUDIT).
#ifdef LAGRAIN_AUDIT
inline constexpr bool kAudited = true;
#else
inline constexpr bool kAudited = false;
#endif

namespace detail {
/// @throws AuditError with the first of the sentences, if there is one
inline void expect_no_defect(const std::string& what, const std::vector<std::string>& defects) {
  if (!defects.empty()) throw AuditError(what + ": " + defects.front());
}

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
