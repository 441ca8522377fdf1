// SPDX-License-Identifier: GPL-3.0-or-later
#include "context.hpp"

#include <lagrain/check.hpp>

#include <cstdlib>
#include <string>

namespace lagrain::detail {

// CMake defines LAGRAIN_OSMESA and LAGRAIN_EGL for the libraries that it has found.
#ifdef LAGRAIN_OSMESA
std::unique_ptr<GlContext> make_osmesa();
#endif
#ifdef LAGRAIN_EGL
std::unique_ptr<GlContext> make_egl();
#endif

std::span<const ContextKind> context_kinds() {
  static constexpr ContextKind kKinds[] = {
#ifdef LAGRAIN_OSMESA
      {"osmesa", make_osmesa},
#endif
#ifdef LAGRAIN_EGL
      {"egl", make_egl},
#endif
  };
  return kKinds;
}

std::unique_ptr<GlContext> make_context() {
  const char* const wanted = std::getenv("LAGRAIN_GL");
  std::string names;
  for (const ContextKind& kind : context_kinds()) {
    if (wanted == nullptr || std::string(wanted) == kind.name) return kind.make();
    names += std::string(names.empty() ? "" : " or ") + kind.name;
  }
  throw SceneError("LAGRAIN_GL is \"" + std::string(wanted) + "\"; this build can draw with " +
                   names);
}

}  // namespace lagrain::detail
