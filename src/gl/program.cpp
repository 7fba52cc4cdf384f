#include "gl/program.h"

#include <string_view>

#include "gl/error.h"
#include "gl/shaders.h"

namespace obscura::gl {
namespace {

const char* text_of(std::string_view name) {
  for (const Shader* shader = kShaders; shader->name; ++shader) {
    if (shader->name == name) return shader->text;
  }
  throw Error("there is no shader " + std::string(name));
}

void compile(const Functions& gl, GLuint program, GLenum stage, const std::string& name) {
  const char* text = text_of(name);
  const GLuint shader = gl.CreateShader(stage);
  gl.ShaderSource(shader, 1, &text, nullptr);
  gl.CompileShader(shader);
  GLint compiled = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  char log[2048] = "";
  if (!compiled) gl.GetShaderInfoLog(shader, sizeof log, nullptr, log);
  gl.AttachShader(program, shader);
  gl.DeleteShader(shader);
  if (!compiled) throw Error("shader " + name + " does not compile: " + log);
}

}  // namespace

Program::Program(const Functions& gl, const std::string& vertex, const std::string& fragment)
    : gl_(gl), name_(gl.CreateProgram()) {
  try {
    compile(gl, name_, GL_VERTEX_SHADER, vertex);
    compile(gl, name_, GL_FRAGMENT_SHADER, fragment);
    gl.LinkProgram(name_);
    GLint linked = 0;
    gl.GetProgramiv(name_, GL_LINK_STATUS, &linked);
    char log[2048] = "";
    if (!linked) gl.GetProgramInfoLog(name_, sizeof log, nullptr, log);
    if (!linked) throw Error("shaders " + vertex + " and " + fragment + " do not link: " + log);
  } catch (...) {
    gl.DeleteProgram(name_);
    throw;
  }
}

Program::~Program() { gl_.DeleteProgram(name_); }

}  // namespace obscura::gl
