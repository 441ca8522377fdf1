// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The OpenGL functions that the painter calls, fetched from the context. In a namespace, because
/// pointers of the same names at global scope would collide with the library's own symbols.
/// Private to render.

#include "context.hpp"

#include <lagrain/display_list.hpp>

#include <GL/glcorearb.h>

#include <mutex>
#include <string>

#define LAGRAIN_GL_FUNCTIONS(X)                                \
  X(ActiveTexture, PFNGLACTIVETEXTUREPROC)                     \
  X(AttachShader, PFNGLATTACHSHADERPROC)                       \
  X(BindBuffer, PFNGLBINDBUFFERPROC)                           \
  X(BindFramebuffer, PFNGLBINDFRAMEBUFFERPROC)                 \
  X(BindTexture, PFNGLBINDTEXTUREPROC)                         \
  X(BindVertexArray, PFNGLBINDVERTEXARRAYPROC)                 \
  X(BlendFunc, PFNGLBLENDFUNCPROC)                             \
  X(BufferData, PFNGLBUFFERDATAPROC)                           \
  X(CheckFramebufferStatus, PFNGLCHECKFRAMEBUFFERSTATUSPROC)   \
  X(Clear, PFNGLCLEARPROC)                                     \
  X(ClearColor, PFNGLCLEARCOLORPROC)                           \
  X(CompileShader, PFNGLCOMPILESHADERPROC)                     \
  X(CreateProgram, PFNGLCREATEPROGRAMPROC)                     \
  X(CreateShader, PFNGLCREATESHADERPROC)                       \
  X(DeleteFramebuffers, PFNGLDELETEFRAMEBUFFERSPROC)           \
  X(DeleteShader, PFNGLDELETESHADERPROC)                       \
  X(DeleteTextures, PFNGLDELETETEXTURESPROC)                   \
  X(DepthFunc, PFNGLDEPTHFUNCPROC)                             \
  X(Disable, PFNGLDISABLEPROC)                                 \
  X(DrawArrays, PFNGLDRAWARRAYSPROC)                           \
  X(DrawArraysInstanced, PFNGLDRAWARRAYSINSTANCEDPROC)         \
  X(DrawBuffer, PFNGLDRAWBUFFERPROC)                           \
  X(Enable, PFNGLENABLEPROC)                                   \
  X(EnableVertexAttribArray, PFNGLENABLEVERTEXATTRIBARRAYPROC) \
  X(FramebufferTexture2D, PFNGLFRAMEBUFFERTEXTURE2DPROC)       \
  X(GenBuffers, PFNGLGENBUFFERSPROC)                           \
  X(GenFramebuffers, PFNGLGENFRAMEBUFFERSPROC)                 \
  X(GenTextures, PFNGLGENTEXTURESPROC)                         \
  X(GenVertexArrays, PFNGLGENVERTEXARRAYSPROC)                 \
  X(GetError, PFNGLGETERRORPROC)                               \
  X(GetIntegerv, PFNGLGETINTEGERVPROC)                         \
  X(GetProgramInfoLog, PFNGLGETPROGRAMINFOLOGPROC)             \
  X(GetProgramiv, PFNGLGETPROGRAMIVPROC)                       \
  X(GetShaderInfoLog, PFNGLGETSHADERINFOLOGPROC)               \
  X(GetShaderiv, PFNGLGETSHADERIVPROC)                         \
  X(GetUniformLocation, PFNGLGETUNIFORMLOCATIONPROC)           \
  X(LinkProgram, PFNGLLINKPROGRAMPROC)                         \
  X(PixelStorei, PFNGLPIXELSTOREIPROC)                         \
  X(ReadBuffer, PFNGLREADBUFFERPROC)                           \
  X(ReadPixels, PFNGLREADPIXELSPROC)                           \
  X(ShaderSource, PFNGLSHADERSOURCEPROC)                       \
  X(TexImage2D, PFNGLTEXIMAGE2DPROC)                           \
  X(TexParameteri, PFNGLTEXPARAMETERIPROC)                     \
  X(Uniform1f, PFNGLUNIFORM1FPROC)                             \
  X(Uniform1fv, PFNGLUNIFORM1FVPROC)                           \
  X(Uniform1i, PFNGLUNIFORM1IPROC)                             \
  X(Uniform2f, PFNGLUNIFORM2FPROC)                             \
  X(Uniform3fv, PFNGLUNIFORM3FVPROC)                           \
  X(Uniform4fv, PFNGLUNIFORM4FVPROC)                           \
  X(UniformMatrix3fv, PFNGLUNIFORMMATRIX3FVPROC)               \
  X(UseProgram, PFNGLUSEPROGRAMPROC)                           \
  X(VertexAttribDivisor, PFNGLVERTEXATTRIBDIVISORPROC)         \
  X(VertexAttribPointer, PFNGLVERTEXATTRIBPOINTERPROC)         \
  X(Viewport, PFNGLVIEWPORTPROC)

namespace lagrain::gl {

#define LAGRAIN_GL_DECLARE(name, type) extern type name;
LAGRAIN_GL_FUNCTIONS(LAGRAIN_GL_DECLARE)
#undef LAGRAIN_GL_DECLARE

/// Largest side of a texture or a framebuffer: llvmpipe's limit.
inline constexpr int kLargest = 16384;

/// The one context of the process, current on this thread while the object lives; others wait. What
/// a painter makes in it (programs, buffers) stays for its next picture.
class Current {
 public:
  /// @throws SceneError if there is no OpenGL 3.3
  Current();
  ~Current();
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
  detail::GlContext* context_;
};

/// The line that every shader begins with.
inline const std::string kVersion = "#version 330 core\n";
/// A line that tells a shader a number under a name.
std::string define(const char* name, int value);

/// Compiles and links a program. @throws ContractError with the compiler's message
GLuint program(const std::string& vertex, const std::string& fragment);

/// A texture without mipmaps, clamped at its edges.
/// @param format, type of the pixels as for glTexImage2D; pixels may be null
GLuint texture(GLint internal, int width, int height, GLenum format, GLenum type,
               const void* pixels, GLint filter);

/// A framebuffer with a colour texture, a depth texture, or both.
class Target {
 public:
  /// @param colour_format, depth_format internal formats, e.g. GL_RGBA8; 0 for no such texture
  Target(GLint colour_format, GLint depth_format)
      : colour_format_(colour_format), depth_format_(depth_format) {}

  /// Binds the framebuffer at a size, with a viewport over all of it; its contents are undefined
  /// after a change of size.
  /// @throws SceneError if there is no memory for it
  void bind(int width, int height);

  GLuint colour() const { return colour_; }
  GLuint depth() const { return depth_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  GLint colour_format_, depth_format_;
  GLuint framebuffer_ = 0, colour_ = 0, depth_ = 0;
  int width_ = 0, height_ = 0;
};

/// Draws a triangle over the whole viewport; the vertex shader to go with it.
extern const char* const kWholeVertexShader;
void draw_whole();

/// Makes a texture current on a unit, counted from 0.
void bind_texture(int unit, GLuint texture);

/// Pixels of the bound framebuffer, from premultiplied to straight alpha.
/// @throws SceneError if OpenGL reports an error
Image read_image(int width, int height);

}  // namespace lagrain::gl
