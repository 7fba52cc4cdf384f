#pragma once

#define GL_GLEXT_PROTOTYPES 1
#include <GL/glcorearb.h>

#include <string>

#include "gl/context.h"

namespace obscura::gl {

// The functions we use, and no others. All are in GL 3.3 core but those below the line, which may be null.
// Laid out by hand: the formatter moves every line of a list of macros when one is added.
// clang-format off
#define OBSCURA_GL_FUNCTIONS(X)                                                                             \
  X(ActiveTexture) X(AttachShader) X(BindBuffer) X(BindFramebuffer) X(BindTexture) X(BindVertexArray)       \
  X(BlendEquation) X(BlendFunc) X(BlitFramebuffer) X(BufferData) X(BufferSubData)                           \
  X(CheckFramebufferStatus) X(Clear) X(ClearColor) X(CompileShader) X(CreateProgram) X(CreateShader)        \
  X(DeleteBuffers) X(DeleteFramebuffers) X(DeleteProgram) X(DeleteShader) X(DeleteTextures)                 \
  X(DeleteVertexArrays) X(Disable) X(DrawArrays) X(DrawArraysInstanced) X(DrawElements) X(Enable)           \
  X(EnableVertexAttribArray) X(FramebufferTexture2D) X(GenBuffers) X(GenFramebuffers) X(GenTextures)        \
  X(GenVertexArrays) X(GetError) X(GetIntegerv) X(GetProgramInfoLog) X(GetProgramiv) X(GetShaderInfoLog)    \
  X(GetShaderiv) X(GetString) X(GetUniformLocation) X(LinkProgram) X(PixelStorei) X(ReadPixels)             \
  X(Scissor) X(ShaderSource) X(TexBuffer) X(TexImage2D) X(TexParameteri) X(TexSubImage2D) X(Uniform1i)      \
  X(Uniform2f) X(Uniform4f) X(UseProgram) X(VertexAttribDivisor) X(VertexAttribPointer) X(Viewport)         \
  X(ClearDepth) X(DepthFunc) X(DrawBuffer) X(ReadBuffer) X(TexImage2DMultisample)
// clang-format on

#define OBSCURA_GL_NEWER_FUNCTIONS(X) X(ClipControl) X(CopyImageSubData) X(DebugMessageCallback)

/// The GL functions of one context. The prototypes give the types alone: nothing is linked.
struct Functions {
#define X(name) decltype(&::gl##name) name = nullptr;
  OBSCURA_GL_FUNCTIONS(X)
  OBSCURA_GL_NEWER_FUNCTIONS(X)
#undef X

  /// Looks every function up in a current context. Throws gl::Error naming one that is missing.
  explicit Functions(const Context& context);

  std::string string(GLenum name) const;
  int integer(GLenum name) const;
};

}  // namespace obscura::gl
