// SPDX-License-Identifier: GPL-3.0-or-later
#include "context.hpp"

#include <lagrain/check.hpp>

// This header brings in GL/gl.h with its global prototypes; it is included here and nowhere else.
#include <GL/osmesa.h>

#include <array>
#include <cstring>

namespace lagrain::detail {
namespace {

class OsMesa final : public GlContext {
 public:
  OsMesa() {
    const std::array<int, 11> attributes{OSMESA_FORMAT,
                                         OSMESA_RGBA,
                                         OSMESA_PROFILE,
                                         OSMESA_CORE_PROFILE,
                                         OSMESA_CONTEXT_MAJOR_VERSION,
                                         3,
                                         OSMESA_CONTEXT_MINOR_VERSION,
                                         3,
                                         OSMESA_DEPTH_BITS,
                                         0,
                                         0};
    context_ = OSMesaCreateContextAttribs(attributes.data(), nullptr);
    if (context_ == nullptr) {
      throw SceneError("OSMesa offers no OpenGL 3.3 core context; Mesa 13 or later has one");
    }
  }
  ~OsMesa() override { OSMesaDestroyContext(context_); }
  OsMesa(const OsMesa&) = delete;
  OsMesa& operator=(const OsMesa&) = delete;

  void make_current() override {
    if (OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, 4, 4) == GL_FALSE) {
      throw SceneError("OSMesa cannot make its context current");
    }
  }
  void release() override { OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0); }

  void* address(const char* name) const override {
    void* data = nullptr;
    const OSMESAproc function = OSMesaGetProcAddress(name);
    static_assert(sizeof data == sizeof function);
    std::memcpy(&data, &function, sizeof data);
    return data;
  }

 private:
  OSMesaContext context_ = nullptr;
  std::array<unsigned char, 64> pixels_{};  // of the default framebuffer, which nobody uses
};

}  // namespace

std::unique_ptr<GlContext> make_osmesa() { return std::make_unique<OsMesa>(); }

}  // namespace lagrain::detail
