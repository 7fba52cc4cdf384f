// The two contact solvers side by side: for each kind of body, contact and joint, how far the exact solver
// and the solver for many bodies are from a closed form and from each other. The table is printed.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "scene/scene.h"
#include "sim/step/run.h"

namespace obscura::scene {
namespace {

constexpr double kG = 9.81, kDegree = std::numbers::pi / 180;
using sim::Vec3;

// A row of the table: a scene, the body that is looked at, where it must be at `time` (s), and how far (m)
// each solver may be from there.
struct Case {
  std::string name, text, body;
  double time;
  Vec3 want;
  double exact, many;
};

Vec3 at(const Case& row, const char* solver) {
  const Scene scene = parse(row.text, "rivals.toml", {std::string("physics.solver=\"") + solver + '"'});
  const auto run = scene.run();
  const auto outcome = run->at(*sim::parse_rational(fmt::format("{}", row.time)));
  const auto* now = std::get_if<sim::Snapshot>(&outcome);
  if (!now) return Vec3::Constant(1e300);
  const auto& bodies = run->scene_info().bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].name == row.body) return now->bodies[i].position;
  return Vec3::Constant(1e300);
}

void compare(const std::vector<Case>& table) {
  fmt::print("{:32} {:>10} {:>10} {:>10}   from the closed form and each other, m\n", "", "exact", "many",
             "apart");
  for (const Case& row : table) {
    const Vec3 exact = at(row, "direct"), many = at(row, "iterative");
    const double by_exact = (exact - row.want).norm(), by_many = (many - row.want).norm();
    fmt::print("{:32} {:10.2e} {:10.2e} {:10.2e}\n", row.name, by_exact, by_many, (exact - many).norm());
    EXPECT_LE(by_exact, row.exact) << row.name << ", exact";
    EXPECT_LE(by_many, row.many) << row.name << ", many";
  }
}

// A point of the plane (z = 0), or of space.
std::string place(bool space, double x, double y) {
  return space ? fmt::format("[{:.17g}, {:.17g}, 0]", x, y) : fmt::format("[{:.17g}, {:.17g}]", x, y);
}

// Shapes 0.2 m high, of 1 kg, friction 0.3 and elasticity 0.5. The middle lies 0.1 m above what they lie on.
struct TestedForm {
  std::string name, keys;
  bool rolls = false;
};
std::vector<TestedForm> forms(bool space) {
  const std::string square = "points = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]";
  const std::string cube =
      "points = [[-0.1, -0.1, -0.1], [0.1, -0.1, -0.1], [0.1, 0.1, -0.1], [-0.1, 0.1, -0.1], [-0.1, -0.1, "
      "0.1], "
      "[0.1, -0.1, 0.1], [0.1, 0.1, 0.1], [-0.1, 0.1, 0.1]]";
  const std::string halves = space ? "shapes = [{ size = [0.1, 0.2, 0.2], position = [-0.05, 0, 0] }, "
                                     "{ size = [0.1, 0.2, 0.2], position = [0.05, 0, 0] }]"
                                   : "shapes = [{ size = [0.1, 0.2], position = [-0.05, 0] }, "
                                     "{ size = [0.1, 0.2], position = [0.05, 0] }]";
  return {{"particle", "[[particle]]\nradius = 0.1"},
          {"ball", "[[ball]]\nradius = 0.1", true},
          {"box", std::string("[[box]]\nsize = ") + (space ? "[0.2, 0.2, 0.2]" : "[0.2, 0.2]")},
          {"capsule", space ? "[[capsule]]\nlength = 0.4\nradius = 0.1\norientation = [0, 0, 90]"
                            : "[[body]]\nshapes = [{ size = [0.2, 0.2] }, { radius = 0.1, position = [-0.1, "
                              "0] }, { radius = 0.1, position = [0.1, 0] }]"},
          {space ? "hull" : "polygon", space ? "[[hull]]\n" + cube : "[[polygon]]\n" + square},
          {"body of two", "[[body]]\n" + halves}};
}
std::string body(const TestedForm& form, bool space, const std::string& name, double x, double y, double vx) {
  return form.keys + fmt::format(
                         "\nname = \"{}\"\nmass = 1\nfriction = 0.3\nelasticity = 0.5\nposition = {}\n"
                         "velocity = {}\n",
                         name, place(space, x, y), place(space, vx, 0));
}

// A plank of 4 kg on a floor without friction, its top at y = 0.
std::string plank(bool space) {
  return std::string(space ? "[room]\nsize = [40, 4, 4]\ncorner = [-20, -0.1, -2]\n"
                           : "[room]\nsize = [40, 4]\ncorner = [-20, -0.1]\n") +
         "friction = 0\n[[box]]\nname = \"plank\"\nmass = 4\nfriction = 0.3\nelasticity = 0.5\nsize = " +
         (space ? "[4, 0.1, 1]" : "[4, 0.1]") + "\nposition = " + place(space, 0, -0.05) + "\n";
}
std::string empty_room(bool space, double gravity) {
  return fmt::format("[room]\nsize = {}\nwalls = \"none\"\ngravity = {}\n", space ? "[8, 4, 4]" : "[8, 4]",
                     place(space, 0, -gravity));
}

void add_contacts(bool space, std::vector<Case>& table) {
  const std::string where = space ? "space" : "plane";
  for (const TestedForm& form : forms(space)) {
    const bool turns = form.rolls;
    // two that lie on each other and on the plank (a ball on a ball would fall)
    if (!turns && form.name != "particle" && form.name != "capsule")
      table.push_back(
          {where + ": stack of " + form.name,
           plank(space) + body(form, space, "low", 0, 0.1, 0) + body(form, space, "high", 0, 0.3, 0),
           "high",
           2,
           {0, 0.3, 0},
           1e-9,
           1e-7});

    // Sliding with v on a plank of M: both end at m v / (m + M), after v / (mu g (1 + m/M)). Rolling begins
    // when the rims agree: J = v / (1/m + r^2/I + 1/M), after J / (mu m g).
    const double v = 1, m = 1, M = 4, mu = 0.3, end = 1.5;
    const double inertia = (space ? 0.4 : 0.5) * m * 0.01;
    const double slip = 1 / m + 1 / M + (turns ? 0.01 / inertia : 0), J = v / slip, until = J / (mu * m * kG);
    const double x = v * end - J / m * (end - until / 2);
    table.push_back({where + (turns ? ": roll of " : ": slide of ") + form.name,
                     plank(space) + body(form, space, "it", -1, 0.1, v),
                     "it",
                     end,
                     {x - 1, 0.1, 0},
                     1e-8,
                     2e-4});

    // One strikes another of its kind, at rest, face to face or along the line of centres: v (1 -+ e) / 2.
    const double reach = form.name == "capsule" ? 0.2 : 0.1, gap = 0.5, speed = 2, e = 0.5, met = gap / speed;
    table.push_back({where + ": impact of " + form.name,
                     empty_room(space, 0) + body(form, space, "first", 0, 1, speed) +
                         body(form, space, "second", 2 * reach + gap, 1, 0),
                     "second",
                     1,
                     {2 * reach + gap + speed * (1 + e) / 2 * (1 - met), 1, 0},
                     1e-12,
                     1e-9});
  }
}

void add_joints(bool space, std::vector<Case>& table) {
  const std::string where = space ? "space" : "plane";
  const std::string size = space ? "size = [0.4, 0.1, 0.1]" : "size = [0.4, 0.1]";
  const auto box = [&](const std::string& name, double x, double y, double vx, double vy, double spin) {
    return fmt::format("[[box]]\nname = \"{}\"\nmass = 1\n{}\nposition = {}\nvelocity = {}\nspin = {}\n",
                       name, size, place(space, x, y), place(space, vx, vy),
                       space ? fmt::format("[0, 0, {:.17g}]", spin) : fmt::format("{:.17g}", spin));
  };
  const auto particle = [&](const std::string& name, double x, double y, double vx, double vy) {
    return fmt::format("[[particle]]\nname = \"{}\"\nmass = 1\nposition = {}\nvelocity = {}\n", name,
                       place(space, x, y), place(space, vx, vy));
  };
  const std::string zero = place(space, 0, 0);
  const double w = 120 * kDegree, r = 0.2;
  // the joint solver is of second order, (w h)^2 / 24 of the way at 600 steps a second; its ropes are of
  // first
  const double second = 4e-6 * r * w;
  const Vec3 turned(r * std::cos(w), r * std::sin(w), 0);

  // turning evenly about a point of the room
  std::vector<std::string> points = {"pin"};
  if (space) points = {"pin", "ball", "hinge"};
  for (const std::string& type : points)
    table.push_back({where + ": " + type,
                     empty_room(space, 0) + box("it", r, 0, 0, w * r, 120) + "[[joint]]\ntype = \"" + type +
                         "\"\nbetween = [\"it\", \"room\"]\nat = " + zero + "\n",
                     "it", 1, turned, 1e-10, second});
  const std::string driven = space ? "hinge" : "pin";
  // a motor strong enough, at its speed from the start
  table.push_back({where + ": motor of a " + driven,
                   empty_room(space, kG) + box("it", r, 0, 0, w * r, 120) + "[[joint]]\ntype = \"" + driven +
                       "\"\nbetween = [\"it\", \"room\"]\nat = " + zero +
                       "\nmotor = { speed = 120, most = 100 }\n",
                   "it", 1, turned, 1e-9, second});
  // dry friction T stops it: angle w^2 I / (2 T), I about the joint
  const double I = (0.16 + 0.01) / 12 + r * r, T = 0.1, angle = w * w * I / (2 * T);
  table.push_back({where + ": friction of a " + driven,
                   empty_room(space, 0) + box("it", r, 0, 0, w * r, 120) + "[[joint]]\ntype = \"" + driven +
                       "\"\nbetween = [\"it\", \"room\"]\nat = " + zero + "\nfriction = 0.1\n",
                   "it", 2, Vec3(r * std::cos(angle), r * std::sin(angle), 0), 1e-9, second});
  // two welded boxes, thrown and spinning about their common centre
  table.push_back({where + ": weld",
                   empty_room(space, kG) + box("it", r, 0, 1, 2 + w * r, 120) +
                       box("other", -r, 0, 1, 2 - w * r, 120) +
                       "[[joint]]\ntype = \"weld\"\nbetween = [\"it\", \"other\"]\nat = " + zero + "\n",
                   "it", 1, Vec3(1, 2 - kG / 2, 0) + turned, 1e-9, second});
  // down a slider at 45 degrees: g sin(45) along it
  table.push_back({where + ": slider",
                   empty_room(space, kG) + box("it", 0, 0, 0, 0, 0) +
                       "[[joint]]\ntype = \"slider\"\nbetween = [\"it\", \"room\"]\naxis = " +
                       place(space, 1, -1) + "\nat = " + zero + "\n",
                   "it", 1, Vec3(kG / 4, -kG / 4, 0), 1e-9, 1e-9});
  // two particles about their middle: on a rod, and on a rope that stays taut
  for (const std::string type : {"rod", "rope"})
    table.push_back({where + ": " + type,
                     empty_room(space, 0) + particle("it", r, 0, 0, w * r) +
                         particle("other", -r, 0, 0, -w * r) + "[[joint]]\ntype = \"" + type +
                         "\"\nbetween = [\"it\", \"other\"]\n",
                     "it", 1, turned, 1e-8, second});
  // a spring between two particles: about the middle, x = x0 cos(sqrt(2 k / m) t) beyond its length
  const double k = 50, stretched = 0.05, length = 2 * r;
  const double half = length / 2 + stretched * std::cos(std::sqrt(2 * k) * 1);
  table.push_back(
      {where + ": spring",
       empty_room(space, 0) + particle("it", r + stretched, 0, 0, 0) +
           particle("other", -r - stretched, 0, 0, 0) +
           fmt::format("[[spring]]\nbetween = [\"it\", \"other\"]\nstiffness = {}\nrest_length = {}\n", k,
                       length),
       "it", 1, Vec3(half, 0, 0), 1e-9, 1e-9});
}

// Bodies and joints that are more than one constraint between two free bodies: limits, springs and motors of
// joints, pulleys, gears, screws, chains, bonds.
void add_mechanisms(bool space, std::vector<Case>& table) {
  const std::string where = space ? "space" : "plane", hinge = space ? "hinge" : "pin";
  const std::string size = space ? "size = [0.4, 0.1, 0.1]" : "size = [0.4, 0.1]";
  const auto box = [&](const std::string& name, double x, double y, double vx, double vy, double spin) {
    return fmt::format("[[box]]\nname = \"{}\"\nmass = 1\n{}\nposition = {}\nvelocity = {}\nspin = {}\n",
                       name, size, place(space, x, y), place(space, vx, vy),
                       space ? fmt::format("[0, 0, {:.17g}]", spin) : fmt::format("{:.17g}", spin));
  };
  const auto on_axle = [&](const std::string& type, const std::string& keys) {
    return fmt::format("[[joint]]\nname = \"axle\"\ntype = \"{}\"\nbetween = [\"it\", \"room\"]\nat = {}\n{}",
                       type, place(space, 0, 0), keys);
  };
  const double w = 120 * kDegree, r = 0.2, own = (0.16 + 0.01) / 12, I = own + r * r;
  const auto turned = [&](double angle) { return Vec3(r * std::cos(angle), r * std::sin(angle), 0); };

  // it turns evenly up to its limit, and stops there; iterations let an overlap of some millionths be
  table.push_back(
      {where + ": limits of a " + hinge,
       empty_room(space, 0) + box("it", r, 0, 0, w * r, 120) + on_axle(hinge, "limits = [-30, 60]\n"), "it",
       1, turned(60 * kDegree), 1e-12, 2e-6});
  // a torsion pendulum through its rest
  const double k = 2, W = std::sqrt(k / I);
  table.push_back({where + ": spring of a " + hinge,
                   empty_room(space, 0) + box("it", r, 0, 0, w * r, 120) +
                       on_axle(hinge, "spring = { stiffness = 2, rest_angle = 0 }\n"),
                   "it", 1, turned(w / W * std::sin(W)), 1e-11, 1e-9});
  // a motor that follows a place, from its speed on
  table.push_back({where + ": motor of a slider",
                   empty_room(space, kG) + box("it", 0, 0, 0.6, 0, 0) +
                       on_axle("slider", "axis = " + place(space, 1, 0) +
                                             "\nmotor = { position = \"0.2*sin(3*t)\", most = 1000 }\n"),
                   "it", 1, Vec3(0.2 * std::sin(3.0), 0, 0), 1e-9, 1e-6});
  // Atwood's machine over two points, 1 kg and 2 kg
  const auto weight = [&](const std::string& name, double x, int mass) {
    return fmt::format("[[particle]]\nname = \"{}\"\nradius = 0.1\nmass = {}\nposition = {}\n", name, mass,
                       place(space, x, 0));
  };
  table.push_back({where + ": pulley",
                   empty_room(space, kG) + weight("it", -1, 1) + weight("other", 1, 2) +
                       "[[joint]]\ntype = \"pulley\"\nbetween = [\"it\", \"other\"]\nover = [" +
                       place(space, -1, 4) + ", " + place(space, 1, 4) + "]\n",
                   "it", 0.8, Vec3(-1, kG / 3 * 0.32, 0), 1e-12, 1e-12});
  // A torque turns two boxes at -2 to 1: T / (I1 + I2 / 4). By iterations it is an impulse in each of 600
  // steps a second, which differs from a force by up to a h^2 / 8.
  const double torque = 0.1, turn = torque / (I + own / 4) / 2, impulses = r * 2 * turn / 8 / (600 * 600.0);
  table.push_back({where + ": gear",
                   empty_room(space, 0) + box("it", r, 0, 0, 0, 0) + box("other", 3, 0, 0, 0, 0) +
                       on_axle(hinge, "motor = { speed = 100000, most = 0.1 }\n") +
                       "[[joint]]\nname = \"second\"\ntype = \"" + hinge +
                       "\"\nbetween = [\"other\", \"room\"]\n[[joint]]\ntype = \"gear\"\njoints = [\"axle\", "
                       "\"second\"]\nratio = -2\n",
                   "it", 1, turned(turn), 1e-12, impulses});
  // a screw that falls turns: m g = (m + I (2 pi / pitch)^2) a
  if (space)
    table.push_back({where + ": screw",
                     empty_room(space, kG) + box("it", 0, 0, 0, 0, 0) +
                         on_axle("screw", "axis = [0, 1, 0]\npitch = 0.5\n"),
                     "it", 1, Vec3(0, -kG / (1 + own * 16 * std::numbers::pi * std::numbers::pi) / 2, 0),
                     1e-9, 1e-9});
  // a link of a chain on a pin
  table.push_back({where + ": link of a chain",
                   empty_room(space, 0) + box("it", r, 0, 0, w * r, 120) + on_axle(hinge, "") +
                       "[[chain]]\nof = [\"it\"]\n",
                   "it", 1, turned(w), 1e-12, 1e-11});
  // two bonded boxes, thrown and spinning about their common centre
  table.push_back({where + ": bond",
                   empty_room(space, kG) + box("it", r, 0, 1, 2 + w * r, 120) +
                       box("other", -r, 0, 1, 2 - w * r, 120) + "[[bond]]\nof = [\"it\", \"other\"]\n",
                   "it", 1, Vec3(1, 2 - kG / 2, 0) + turned(w), 1e-11, 1e-11});
}

// Contacts with what is fixed or moved: a slope, a belt, a table that accelerates, a wall that strikes, a
// floor.
void add_moved(bool space, std::vector<Case>& table) {
  const std::string where = space ? "space" : "plane";
  const auto block = [&](double x, double y, const std::string& keys = "") {
    return std::string("[[box]]\nname = \"it\"\nmass = 1\nfriction = 0.3\nelasticity = 0\nsize = ") +
           (space ? "[0.4, 0.2, 0.2]" : "[0.4, 0.2]") + "\nposition = " + place(space, x, y) + "\n" + keys;
  };
  const auto base = [&](const std::string& keys, double elasticity = 0) {
    return fmt::format("[[box]]\nname = \"base\"\nfriction = 0.3\nelasticity = {}\nsize = ", elasticity) +
           (space ? "[8, 0.2, 2]" : "[8, 0.2]") + "\nposition = " + place(space, 0, -0.1) + "\n" + keys;
  };
  const auto turned = [&](double degrees) {
    return space ? fmt::format("orientation = [0, 0, {}]\n", degrees) : fmt::format("angle = {}\n", degrees);
  };
  const double mu = 0.3;

  // Down a slope of 30 degrees from rest, a = g (sin - mu cos). The base lies 0.1 below the middle of its
  // top.
  const double sine = 0.5, cosine = std::sqrt(0.75);
  const auto along = [&](double way) {
    return Vec3(0.1 * sine + 0.1 * sine + way * cosine, -0.1 + 0.1 * cosine + 0.1 * cosine - way * sine, 0);
  };
  table.push_back({where + ": slide down a slope",
                   empty_room(space, kG) + base("fixed = true\n" + turned(-30)) +
                       block(along(-2)[0], along(-2)[1], turned(-30)),
                   "it", 1, along(-2 + kG * (sine - mu * cosine) / 2), 1e-12, 1e-12});
  // at rest on a belt of speed u: it slips for u / (mu g), then goes along
  const double u = 1.5, slips = u / (mu * kG);
  table.push_back(
      {where + ": belt",
       empty_room(space, kG) +
           base(std::string("fixed = true\nsurface_speed = ") + (space ? "[1.5, 0, 0]" : "1.5") + "\n") +
           block(-2, 0.1),
       "it", 1, Vec3(-2 + u * (1 - slips / 2), 0.1, 0), 1e-11, 2e-6});
  // on a table that accelerates by less than mu g: it goes along
  table.push_back({where + ": table that accelerates",
                   empty_room(space, kG) + base("motion = { x = \"t^2\" }\n") + block(-2, 0.1), "it", 1,
                   Vec3(-1, 0.1, 0), 1e-12, 1e-11});
  // struck by what is moved at 2 m/s, 0.5 m away: it leaves with (1 + e) times that
  const std::string ball = "[[ball]]\nradius = 0.1\nelasticity = 0.5\nname = ";
  table.push_back({where + ": struck by what is moved",
                   empty_room(space, 0) + ball + "\"hand\"\nmotion = { x = \"2*t\" }\nposition = " +
                       place(space, 0, 1) + "\n" + ball + "\"it\"\nposition = " + place(space, 0.7, 1) + "\n",
                   "it", 1, Vec3(0.7 + 3 * 0.75, 1, 0), 1e-11, 1e-11});
  // dropped from 0.5 m onto what is fixed: up again with e times the speed
  const double fall = std::sqrt(2 * 0.5 / kG), t = 0.5 - fall;
  table.push_back({where + ": bounce",
                   empty_room(space, kG) + base("fixed = true\n", 0.5) + ball +
                       "\"it\"\nposition = " + place(space, 0, 0.6) + "\n",
                   "it", 0.5, Vec3(0, 0.1 + 0.5 * kG * fall * t - kG / 2 * t * t, 0), 1e-9, 1e-9});
}

TEST(Rivals, ContactsInThePlane) {
  std::vector<Case> table;
  add_contacts(false, table);
  compare(table);
}
TEST(Rivals, ContactsInSpace) {
  std::vector<Case> table;
  add_contacts(true, table);
  compare(table);
}
TEST(Rivals, JointsInThePlane) {
  std::vector<Case> table;
  add_joints(false, table);
  compare(table);
}
TEST(Rivals, JointsInSpace) {
  std::vector<Case> table;
  add_joints(true, table);
  compare(table);
}

TEST(Rivals, MechanismsInThePlane) {
  std::vector<Case> table;
  add_mechanisms(false, table);
  compare(table);
}
TEST(Rivals, MechanismsInSpace) {
  std::vector<Case> table;
  add_mechanisms(true, table);
  compare(table);
}
TEST(Rivals, OnWhatIsFixedOrMovedInThePlane) {
  std::vector<Case> table;
  add_moved(false, table);
  compare(table);
}
TEST(Rivals, OnWhatIsFixedOrMovedInSpace) {
  std::vector<Case> table;
  add_moved(true, table);
  compare(table);
}

}  // namespace
}  // namespace obscura::scene
