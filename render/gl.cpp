#include "gl.hpp"

#include <lagrain/check.hpp>

#include <array>
#include <cstring>

namespace lagrain::gl {

#define LAGRAIN_GL_DEFINE(name, type) type name = nullptr;
LAGRAIN_GL_FUNCTIONS(LAGRAIN_GL_DEFINE)
#undef LAGRAIN_GL_DEFINE

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

namespace {

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

}  // namespace lagrain::gl
