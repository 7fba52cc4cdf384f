// Rooms whose lengths and gravity are 2^k times as large, on joints: the same run, every number 2^k times as
// large, to the bit. A joint that compares metres with radians, or either with a number, would tell them
// apart.

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "obscura/obscura.h"

namespace obscura {
namespace {

// `<1.5>` is a length, `<<1.5>>` the square of one, as of a torque
std::string scaled(const std::string& text, double s) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] != '<') {
      out += text[at++];
      continue;
    }
    const bool square = text[at + 1] == '<';
    const std::size_t begin = at + (square ? 2 : 1), end = text.find('>', begin);
    char number[40];
    const double value = std::stod(text.substr(begin, end - begin)) * (square ? s * s : s);
    out.append(number, std::to_chars(number, number + sizeof number, value).ptr);
    at = end + (square ? 2 : 1);
  }
  return out;
}

const std::string kPlane = "[room]\nsize = [<4>, <3>]\ngravity = [<0>, <-10>]\n";
const std::string kSpace = "[room]\nsize = [<4>, <3>, <4>]\ngravity = [<0>, <-10>, <0>]\n";

const std::string kBars = R"(
[[box]]
name = "a"
size = [<0.3>, <0.1>]
position = [<1.15>, <2>]
mass = 1
[[box]]
name = "b"
size = [<0.3>, <0.1>]
position = [<1.45>, <2>]
mass = 0.7
[[box]]
name = "c"
size = [<0.3>, <0.1>]
position = [<1.75>, <2>]
mass = 1.3
)";

// three bars in a row, from the room
std::string row_of(const std::string& type, const std::string& more = "") {
  return kPlane + kBars + "[[joint]]\ntype = \"" + type +
         "\"\nbetween = [\"a\", [<1>, <2>]]\n[[joint]]\ntype = \"" + type +
         "\"\nbetween = [\"a\", \"b\"]\nat = [<1.3>, <2>]\n" + more + "[[joint]]\ntype = \"" + type +
         "\"\nbetween = [\"b\", \"c\"]\nat = [<1.6>, <2>]\n";
}

const std::string kBlocks = R"(
[[box]]
name = "a"
size = [<0.3>, <0.1>, <0.2>]
position = [<-0.85>, <2>, <0>]
mass = 1
[[box]]
name = "b"
size = [<0.3>, <0.1>, <0.2>]
position = [<-0.55>, <2>, <0.1>]
mass = 1.3
)";

std::string hinged(const std::string& first, const std::string& second) {
  return kSpace + kBlocks + "[[joint]]\ntype = \"hinge\"\nbetween = [\"a\", [<-1>, <2>, <0>]]\n" + first +
         "[[joint]]\ntype = \"hinge\"\nbetween = [\"a\", \"b\"]\nat = [<-0.7>, <2>, <0.1>]\n" + second;
}

const std::map<std::string, std::string>& rooms() {
  static const std::map<std::string, std::string> all = {
      {"pins", row_of("pin")},
      {"welds", row_of("weld")},
      {"limits", row_of("pin", "limits = [-20, 30]\n")},
      {"motor", row_of("pin", "motor = { speed = 90, most = <<4>> }\n")},
      {"friction", row_of("pin", "friction = <<0.2>>\n")},
      {"spring", row_of("pin", "spring = { stiffness = <<3>>, damping = <<0.05>>, rest_angle = 20 }\n")},
      {"servo", row_of("pin", "motor = { angle = \"40*sin(5*t)\", most = <<9>> }\n")},
      {"gear", kPlane + R"(
[[ball]]
name = "a"
radius = <0.3>
position = [<1.5>, <1.5>]
mass = 1
[[ball]]
name = "b"
radius = <0.5>
position = [<2.3>, <1.5>]
mass = 2
[[joint]]
name = "p"
type = "pin"
between = ["a", [<1.5>, <1.5>]]
motor = { speed = 200, most = <<0.3>> }
[[joint]]
name = "q"
type = "pin"
between = ["b", [<2.3>, <1.5>]]
[[joint]]
type = "gear"
joints = ["p", "q"]
ratio = -1.6666666666666667
)"},
      {"screw", kSpace + kBlocks + R"(
[[joint]]
type = "screw"
between = ["a", [<-0.85>, <2>, <0>]]
axis = [0, 1, 0]
pitch = <0.3>
)"},
      {"ropes", kPlane + R"(
[[particle]]
name = "a"
position = [<1.5>, <2>]
mass = 1
[[particle]]
name = "b"
position = [<1.9>, <2.2>]
mass = 0.4
[[joint]]
type = "rod"
between = [[<1>, <2>], "a"]
[[joint]]
type = "rope"
between = ["a", "b"]
length = <0.6>
)"},
      {"slider", kPlane + R"(
[[box]]
name = "a"
size = [<0.4>, <0.2>]
position = [<2>, <1>]
mass = 2
[[box]]
name = "b"
size = [<0.1>, <0.6>]
position = [<2>, <0.7>]
mass = 1
[[joint]]
type = "slider"
between = ["a", [<2>, <1>]]
axis = [1, 0]
limits = [<-0.1>, <0.3>]
[[joint]]
type = "pin"
between = ["a", "b"]
at = [<2>, <1>]
[[spring]]
between = ["b", [<3>, <0.4>]]
stiffness = 20
rest_length = <0.5>
)"},
      {"hinge", hinged("axis = [0.2, 0, 1]\n", "axis = [0, 0, 1]\n")},
      {"hinge with limits",
       hinged("axis = [0, 0, 1]\nlimits = [-60, 30]\n", "axis = [0.1, 0, 1]\nlimits = [-20, 20]\n")},
  };
  return all;
}

std::vector<double> numbers(const Columns& columns, double over) {
  std::vector<double> all;
  for (std::size_t i = 0; i < columns.size(); ++i) all.push_back(columns.first[i] / over);
  return all;
}

TEST(ScaledRooms, AreTheSameRunOnJoints) {
  for (const auto& [name, text] : rooms())
    for (const std::string solver : {"direct", "iterative"})
      for (const int rate : {60, 240}) {
        const auto run = [&](int k) {
          const double s = std::ldexp(1.0, k);
          World world(Scene::parse(scaled(text, s) + "[physics]\nsolver = \"" + solver +
                                   "\"\nrate = " + std::to_string(rate) + "\n"));
          world.step(rate);
          std::vector<double> all = numbers(world.positions(), s);
          for (const double v : numbers(world.velocities(), s)) all.push_back(v);
          for (const double w : numbers(world.spins(), 1)) all.push_back(w);
          return all;
        };
        const std::vector<double> want = run(0);
        for (const int k : {-20, -7, -1, 3, 12, 20})
          EXPECT_EQ(run(k), want) << name << ", " << solver << " at " << rate << ", 2^" << k;
      }
}

}  // namespace
}  // namespace obscura
