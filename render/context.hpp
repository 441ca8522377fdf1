// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// A headless OpenGL 3.3 core context. Only its sources know where the context comes from; the
/// painter draws into framebuffers of its own. Private to render.

#include <memory>
#include <span>

namespace lagrain::detail {

class GlContext {
 public:
  virtual ~GlContext() = default;

  /// Makes the context current on this thread, or on none.
  virtual void make_current() = 0;
  virtual void release() = 0;
  /// Address of an OpenGL function. A null check proves nothing: unknown names give addresses too.
  virtual void* address(const char* name) const = 0;
};

/// A way to a context. All ways lead to Mesa's software rasteriser, and to the same pictures.
struct ContextKind {
  const char* name;
  /// @throws SceneError if there is no OpenGL 3.3
  std::unique_ptr<GlContext> (*make)();
};

/// The ways that are built in, at least one; the first one is preferred.
std::span<const ContextKind> context_kinds();

/// A context of the kind that the environment variable LAGRAIN_GL names, by default the first one.
/// @throws SceneError if no such kind is built in, or there is no OpenGL 3.3
std::unique_ptr<GlContext> make_context();

}  // namespace lagrain::detail
