// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl.hpp"

#include <lagrain/check.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

namespace lagrain::gl {

#define LAGRAIN_GL_DEFINE(name, type) type name = nullptr;
LAGRAIN_GL_FUNCTIONS(LAGRAIN_GL_DEFINE)
#undef LAGRAIN_GL_DEFINE

namespace {

// Fetches the functions of the current context.
void load(const detail::GlContext& context) {
  void* address = nullptr;
#define LAGRAIN_GL_FETCH(name, type)     \
  address = context.address("gl" #name); \
  std::memcpy(&name, &address, sizeof address);
  LAGRAIN_GL_FUNCTIONS(LAGRAIN_GL_FETCH)
#undef LAGRAIN_GL_FETCH

  GLint major = 0, minor = 0;
  GetIntegerv(GL_MAJOR_VERSION, &major);
  GetIntegerv(GL_MINOR_VERSION, &minor);
  if (10 * major + minor < 33) {
    throw SceneError("OpenGL 3.3 is needed, found " + std::to_string(major) + "." +
                     std::to_string(minor));
  }
}

// Never destroyed: at exit the OpenGL library may be gone before us.
detail::GlContext* make_shared_context() {
  std::unique_ptr<detail::GlContext> context = detail::make_context();
  context->make_current();
  load(*context);
  return context.release();
}

std::mutex& context_mutex() {
  static std::mutex mutex;
  return mutex;
}

GLuint shader(GLenum kind, const std::string& source) {
  const GLuint id = CreateShader(kind);
  const char* text = source.c_str();
  ShaderSource(id, 1, &text, nullptr);
  CompileShader(id);
  GLint good = 0;
  GetShaderiv(id, GL_COMPILE_STATUS, &good);
  if (good == 0) {
    std::array<char, 2000> log{};
    GetShaderInfoLog(id, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw ContractError(std::string("shader: ") + log.data());
  }
  return id;
}

}  // namespace

Current::Current() : lock_(context_mutex()) {
  static detail::GlContext* const shared = make_shared_context();
  context_ = shared;
  context_->make_current();
}

Current::~Current() { context_->release(); }

std::string define(const char* name, int value) {
  return std::string("#define ").append(name).append(" ").append(std::to_string(value)) + "\n";
}

GLuint program(const std::string& vertex, const std::string& fragment) {
  const GLuint id = CreateProgram();
  const GLuint v = shader(GL_VERTEX_SHADER, vertex), f = shader(GL_FRAGMENT_SHADER, fragment);
  AttachShader(id, v);
  AttachShader(id, f);
  LinkProgram(id);
  DeleteShader(v);
  DeleteShader(f);
  GLint good = 0;
  GetProgramiv(id, GL_LINK_STATUS, &good);
  if (good == 0) {
    std::array<char, 2000> log{};
    GetProgramInfoLog(id, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw ContractError(std::string("shader program: ") + log.data());
  }
  return id;
}

GLuint texture(GLint internal, int width, int height, GLenum format, GLenum type,
               const void* pixels, GLint filter) {
  GLuint id = 0;
  GenTextures(1, &id);
  BindTexture(GL_TEXTURE_2D, id);
  PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  TexImage2D(GL_TEXTURE_2D, 0, internal, width, height, 0, format, type, pixels);
  TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return id;
}

void Target::bind(int width, int height) {
  if (width == width_ && height == height_) {
    BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    Viewport(0, 0, width, height);
    return;
  }
  if (framebuffer_ != 0) DeleteFramebuffers(1, &framebuffer_);
  GenFramebuffers(1, &framebuffer_);
  BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  const auto attach = [&](GLuint& texture, GLenum where, GLint internal, GLenum format,
                          GLenum type) {
    if (texture != 0) DeleteTextures(1, &texture);
    texture = gl::texture(internal, width, height, format, type, nullptr, GL_NEAREST);
    FramebufferTexture2D(GL_FRAMEBUFFER, where, GL_TEXTURE_2D, texture, 0);
  };
  if (colour_format_ != 0) {
    attach(colour_, GL_COLOR_ATTACHMENT0, colour_format_, GL_RGBA, GL_UNSIGNED_BYTE);
  } else {
    DrawBuffer(GL_NONE);
    ReadBuffer(GL_NONE);
  }
  if (depth_format_ != 0) {
    attach(depth_, GL_DEPTH_ATTACHMENT, depth_format_, GL_DEPTH_COMPONENT, GL_FLOAT);
  }
  width_ = width;
  height_ = height;
  if (CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    width_ = height_ = 0;
    throw SceneError("OpenGL has no memory for a picture of " + std::to_string(width) + " x " +
                     std::to_string(height) + " samples");
  }
  Viewport(0, 0, width, height);
}

const char* const kWholeVertexShader = R"(#version 330 core
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = vec4(4.0 * corner - 1.0, 0.0, 1.0);
}
)";

void draw_whole() {
  static const GLuint empty = [] {
    GLuint id = 0;
    GenVertexArrays(1, &id);
    return id;
  }();
  BindVertexArray(empty);
  DrawArrays(GL_TRIANGLES, 0, 3);
}

void bind_texture(int unit, GLuint texture) {
  ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  BindTexture(GL_TEXTURE_2D, texture);
}

Image read_image(int width, int height) {
  Image image{width, height, {}};
  const auto row = 4 * static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
  image.rgba.resize(row * rows);
  PixelStorei(GL_PACK_ALIGNMENT, 1);
  ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  const GLenum error = GetError();
  if (error != GL_NO_ERROR) throw SceneError("OpenGL error " + std::to_string(error));
  for (std::size_t y = 0; y < rows / 2; ++y) {
    std::swap_ranges(image.rgba.data() + y * row, image.rgba.data() + (y + 1) * row,
                     image.rgba.data() + (rows - 1 - y) * row);
  }
  for (std::size_t k = 0; k < image.rgba.size(); k += 4) {
    const int alpha = image.rgba[k + 3];
    if (alpha == 255 || alpha == 0) continue;
    for (std::size_t c = k; c < k + 3; ++c) {
      image.rgba[c] =
          static_cast<std::uint8_t>(std::min(255, (image.rgba[c] * 255 + alpha / 2) / alpha));
    }
  }
  return image;
}

}  // namespace lagrain::gl
