#pragma once
/// @file
/// A headless OpenGL 3.3 core context. Only its source knows where the context comes from; the
/// painter draws into framebuffers of its own. Private to render.

#include <memory>

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

/// @throws SceneError if there is no OpenGL 3.3
std::unique_ptr<GlContext> make_context();

}  // namespace lagrain::detail
