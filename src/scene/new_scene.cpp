#include "scene/keys.h"

namespace obscura::scene {

namespace {

// a name as a title: "my-first_room" is "My first room"
std::string titled(const std::string& name) {
  std::string title;
  for (const char c : name) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) continue;
    if (c == '"' || c == '\\') title += '\\';
    title += c == '-' || c == '_' ? ' ' : c;
  }
  if (!title.empty() && title[0] >= 'a' && title[0] <= 'z') title[0] = char(title[0] - 'a' + 'A');
  return title;
}

}  // namespace

std::string new_scene(const std::string& name) {
  return "title    = \"" + titled(name) + R"toml("
subtitle = "a ball, a box on a spring, and a hand"
duration = 10                              # seconds

[room]
size = [8, 4.5]                            # metres; the origin is the left end of the floor

[[particle]]
name       = "ball"
position   = [1, 3.5]
velocity   = [1.2, 0]
radius     = 0.1
elasticity = 0.9                           # 0: it stays where it lands; 1: it rebounds at full speed

[[box]]
name     = "crate"
size     = [1.0, 0.6]
position = [5, 2.2]
angle    = 20                              # degrees
drag     = 0.1

[[spring]]
between     = [[5, 4.5], { body = "crate", at = "top" }]   # a place in the room, a point of a body
stiffness   = 12                           # newtons per metre
rest_length = 1.2                          # default: its length at the start

[[mouse]]                                  # grips the closest particle or corner; lets go at the last time
path = [[3, 5.6, 1.6], [4, 7, 2.5], [5, 7.2, 1.2]]         # time, x, y

[look]
theme  = "paper"                           # or "screen", for a dark hall
trails = { ball = 1.5 }                    # seconds
)toml";
}

}  // namespace obscura::scene
