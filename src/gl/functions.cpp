#include "gl/functions.h"

#include "gl/error.h"

namespace obscura::gl {

Functions::Functions(const Context& context) {
#define X(name) name = reinterpret_cast<decltype(name)>(context.function("gl" #name));
  OBSCURA_GL_FUNCTIONS(X)
  OBSCURA_GL_NEWER_FUNCTIONS(X)
#undef X
#define X(name) \
  if (!name) throw Error(context.backend() + ": OpenGL 3.3 core is needed, and gl" #name " is missing");
  OBSCURA_GL_FUNCTIONS(X)
#undef X
}

std::string Functions::string(GLenum name) const {
  const GLubyte* text = GetString(name);
  return text ? reinterpret_cast<const char*>(text) : "";
}

int Functions::integer(GLenum name) const {
  GLint value = 0;
  GetIntegerv(name, &value);
  return value;
}

}  // namespace obscura::gl
