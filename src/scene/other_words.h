#pragma once

#include <string_view>

namespace obscura::scene {

/// What obscura has for a key by which other programs of this field go (Box2D, MuJoCo, pymunk, SDF, Blender)
/// or a book, as the end of a message: "; it is 'elasticity' here". Empty: none is known of `owner`, the
/// table that it stands in; the top's is "".
std::string_view other_word(std::string_view key, std::string_view owner);

}  // namespace obscura::scene
