#pragma once

#include <string>

#include "gl/functions.h"

namespace obscura::gl {

/// A linked program of two of the embedded shaders.
class Program {
 public:
  /// "disc.vert", "dot.frag". Throws gl::Error with the compiler's words.
  Program(const Functions& gl, const std::string& vertex, const std::string& fragment);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const { gl_.UseProgram(name_); }
  /// The location of a uniform, -1 if there is none.
  int uniform(const char* name) const { return gl_.GetUniformLocation(name_, name); }

 private:
  const Functions& gl_;
  GLuint name_ = 0;
};

}  // namespace obscura::gl
