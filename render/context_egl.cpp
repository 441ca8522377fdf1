// SPDX-License-Identifier: GPL-3.0-or-later
#include "context.hpp"

#include <lagrain/check.hpp>

// Nothing is drawn into windows: the headers of a window system need not be there.
#define EGL_NO_PLATFORM_SPECIFIC_TYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <cstring>

namespace lagrain::detail {
namespace {

template <class Function>
Function egl_function(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

// Mesa's software rasteriser is taken even where there is a graphics card, so that the pictures are
// the same bits with and without one. EGL counts it as a device of its own
// (EGL_EXT_platform_device, EGL_MESA_device_software).
EGLDisplay software_display() {
  const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto query_string = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  if (query_devices == nullptr || query_string == nullptr) return EGL_NO_DISPLAY;

  std::array<EGLDeviceEXT, 64> devices{};
  EGLint count = 0;
  if (query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_FALSE) {
    return EGL_NO_DISPLAY;
  }
  for (EGLint k = 0; k < count; ++k) {
    const EGLDeviceEXT device = devices[static_cast<std::size_t>(k)];
    const char* const extensions = query_string(device, EGL_EXTENSIONS);
    if (extensions != nullptr && std::strstr(extensions, "EGL_MESA_device_software") != nullptr) {
      return eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
    }
  }
  return EGL_NO_DISPLAY;
}

class Egl final : public GlContext {
 public:
  Egl() : display_(software_display()) {
    if (display_ == EGL_NO_DISPLAY || eglInitialize(display_, nullptr, nullptr) == EGL_FALSE) {
      throw SceneError("EGL finds no software renderer (Debian: libegl-mesa0, libgl1-mesa-dri)");
    }
    const std::array<EGLint, 7> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                           3,
                                           EGL_CONTEXT_MINOR_VERSION,
                                           3,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                           EGL_NONE};
    eglBindAPI(EGL_OPENGL_API);
    // There is no surface, hence no configuration of one (EGL_KHR_no_config_context).
    context_ = eglCreateContext(display_, EGLConfig{}, EGL_NO_CONTEXT, attributes.data());
    if (context_ == EGL_NO_CONTEXT) {
      throw SceneError("EGL offers no OpenGL 3.3 core context; Mesa 13 or later has one");
    }
  }
  // The display is left open: the whole process shares it, and others may use it.
  ~Egl() override { eglDestroyContext(display_, context_); }
  Egl(const Egl&) = delete;
  Egl& operator=(const Egl&) = delete;

  void make_current() override {
    if (!bind(context_)) throw SceneError("EGL cannot make its context current");
  }
  void release() override { bind(EGL_NO_CONTEXT); }

  void* address(const char* name) const override { return egl_function<void*>(name); }

 private:
  // EGL speaks of the OpenGL that this thread chose last.
  bool bind(EGLContext context) {
    return eglBindAPI(EGL_OPENGL_API) == EGL_TRUE &&
           eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE;
  }

  EGLDisplay display_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlContext> make_egl() { return std::make_unique<Egl>(); }

}  // namespace lagrain::detail
