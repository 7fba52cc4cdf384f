#pragma once

namespace obscura::gl {

/// A file of shaders/, embedded when the library was built.
struct Shader {
  const char* name;  // "disc.vert"
  const char* text;
};

/// All of them; the last has no name.
extern const Shader kShaders[];

}  // namespace obscura::gl
