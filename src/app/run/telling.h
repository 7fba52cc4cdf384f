#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "draw/picture/look.h"
#include "sim/model/snapshot.h"

/// Numbers, places, motions and bodies as sentences have them, in SI units.
namespace obscura::app::telling {

/// Three digits that count; of what is very small or large with a power of ten: "2.5e-6".
std::string numeral(double x);
/// "0.45 s", to a thousandth of `duration` (s), or of a second of what lasts longer.
std::string time(double t, double duration);
/// "(1, 0.25) m"
std::string whereabouts(const sim::Vec3& p, const sim::SceneInfo& cast);
/// "the ball", "brick[3]"
std::string called(const sim::SceneInfo& cast, int body);
std::string capital(std::string text);
/// "the floor", "the slope"
std::string wall(const sim::SceneInfo& cast, int index);
/// "at 3 m/s to the right and up"
std::string motion(const sim::Vec3& v, const sim::SceneInfo& cast);
/// Whether it is slower than what is told as a motion: 1e-9 of the room's height a second.
bool stands(const sim::Vec3& v, const sim::SceneInfo& cast);
/// Whether a body of this spin (rad/s) is told to turn: faster than 1e-9 rad/s.
bool turns(const sim::Vec3& spin);
/// "moves at 3 m/s to the right", "turns at 2 rad/s", "does not move"
std::string moves(const sim::Vec3& v, const sim::Vec3& spin, const sim::SceneInfo& cast);
/// "a, b and c"
std::string together(std::vector<std::string> all);
/// Title and subtitle of a scene.
std::string headline(const draw::Look& look);
/// "one spring", "3 springs"
std::string count(std::size_t n, const char* one, const char* many);
/// The numbers of bodies that are not fixed.
std::vector<int> moving(const sim::SceneInfo& cast);
/// "one ball, 3 boxes and 2 springs"
std::string listed(const sim::SceneInfo& cast);

}  // namespace obscura::app::telling
