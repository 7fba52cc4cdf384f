// Forces, motion, mechanisms, tracks and events in everything that the program does with a scene: a run that
// goes on from a checkpoint, shards, --set and sweeps, export, figures and goldens.

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "program.h"

namespace obscura::app {
namespace {

struct Feature {
  std::string name, scene;
  std::string set;                        // a key of it that changes its run
  std::vector<std::string> physics = {};  // it is tried with each of these in [physics] as well
};

const std::string kStart = "duration = 1\n[physics]\nrate = 240\n";
const std::string kFlat = kStart + "[room]\nsize = [4, 2.25]\n";
const std::string kDeep = kStart + "[room]\nsize = [4, 2.25, 2]\n";
const std::string kBall =
    "[[ball]]\nname = 'ball'\nradius = 0.15\nposition = [1, 1.5]\nvelocity = [1, 0.5]\n";
const std::string kLow = "[[ball]]\nname = 'ball'\nradius = 0.15\nposition = [1, 0.5]\nvelocity = [1, 0]\n";
const std::string kTable = R"([[box]]
name = 'table'
size = [3, 0.2]
position = [2, 0.6]
motion = { x = '0.2*sin(6*t)', angle = '10*sin(5*t)' }
)";
const std::string kRope = R"([[box]]
name = 'a'
size = [0.2, 0.2]
position = [1.5, 1]
[[box]]
name = 'b'
size = [0.3, 0.2]
position = [2.5, 1]
[[ball]]
name = 'wheel'
radius = 0.2
position = [2, 2]
[[joint]]
type = 'pin'
between = ['wheel', 'room']
[[joint]]
name = 'rope'
type = 'pulley'
between = ['a', 'b']
over = ['wheel']
)";
const std::string kGears = R"([[ball]]
name = 'small'
radius = 0.2
position = [1, 1.2]
[[ball]]
name = 'large'
radius = 0.4
position = [1.6, 1.2]
[[box]]
name = 'rack'
size = [0.2, 1]
position = [2.1, 1]
[[joint]]
name = 'axle'
type = 'pin'
between = ['small', 'room']
motor = { speed = '90*t', most = 1 }
[[joint]]
name = 'other'
type = 'pin'
between = ['large', 'room']
[[joint]]
name = 'guide'
type = 'slider'
between = ['rack', 'room']
axis = [0, 1]
[[joint]]
type = 'gear'
joints = ['axle', 'other']
ratio = -2
[[joint]]
type = 'gear'
joints = ['guide', 'other']
ratio = 0.4
)";
const std::string kRail = R"([[ball]]
name = 'ball'
radius = 0.15
position = [0.6, 1.8]
[[track]]
name = 'way'
points = [[0.2, 1.8], [1.5, 0.5], { to = [3.5, 1] }]
friction = 0.5
)";
const std::string kEvents = kBall + R"([[box]]
name = 'gate'
size = [0.2, 1]
position = [2, 1.4]
fixed = true
[[joint]]
name = 'rope'
type = 'rope'
between = ['ball', [1, 2.2]]
breaks = 20
[[when]]
touches = ['ball', 'gate']
do = [{ mark = 'hit' }, { release = 'gate' }]
[[when]]
value = 'ball.y < 0.8'
again = true
do = [{ mark = 'low' }, { set = 'room.gravity', to = [0, -3] }]
[[when]]
time = 0.6
do = [{ set = 'gate.fixed', to = true }]
)";
const std::string kIterative = "solver = 'iterative'", kEvent = "collision = 'event'";

const std::vector<Feature>& features() {
  static const std::vector<Feature> written{
      {"force",
       kFlat + kBall + "[[force]]\nname = 'f'\nof = 'ball'\ncomponents = ['-3*vx*speed', '2*sin(9*t)']\n",
       "f.components=['0', '5']",
       {kIterative, kEvent}},
      {"potential", kFlat + kBall + "[constants]\nk = 9\n[[force]]\nof = 'ball'\npotential = 'k*(x-2)^2/2'\n",
       "constants.k=4"},
      {"pairs",
       kFlat + "gravitation = 0.5\nsoftening = 0.1\n" + kBall +
           "[[ball]]\nname = 'other'\nposition = [3, 1]\n[[force]]\nbetween = ['ball', 'other']\n"
           "potential = '2*(r-1)^2'\n",
       "room.gravitation=0.1"},
      {"charge", kFlat + "magnetic = 3\nelectric = [0, 1]\n" + kBall + "charge = 2\n", "room.magnetic=-3"},
      {"air", kFlat + "wind = [3, 0]\nquadratic_drag = 0.3\n" + kBall, "room.quadratic_drag=0.1"},
      {"fluid", kFlat + "fluid = { level = 1, density = 2 }\n" + kBall, "room.fluid.density=3", {kIterative}},
      {"motion", kFlat + kBall + kTable, "table.motion.x='0.1*t'", {kIterative}},
      {"release",
       kFlat + kBall +
           "[[box]]\nname = 'table'\nsize = [3, 0.2]\nrelease = 0.4\n"
           "motion = { path = [[0, 2, 0.6], [0.5, 2, 1], [1, 2, 0.6]] }\n",
       "table.release=0.7",
       {kIterative, kEvent}},
      {"belt",
       kFlat + kLow +
           "[[box]]\nname = 'belt'\nsize = [3, 0.2]\nposition = [2, 0.2]\nfixed = true\nsurface_speed = 2\n",
       "belt.surface_speed=-1",
       {kIterative}},
      {"pulley", kFlat + kRope, "b.mass=0.05", {kIterative}},
      {"gears", kFlat + kGears, "axle.motor.speed='45*t'", {kIterative}},
      {"coils",
       kFlat + "[[box]]\nname = 'bar'\nposition = [1, 1]\nspin = 90\n[[joint]]\nname = 'p'\ntype = 'pin'\n"
               "between = ['bar', 'room']\nspring = { stiffness = 2, damping = 0.1, rest_angle = 30 }\n",
       "p.spring.stiffness=5",
       {kIterative}},
      {"screw",
       kDeep + "[[box]]\nname = 'nut'\nsize = [0.3, 0.3, 0.3]\nposition = [0, 1, 0]\n[[joint]]\nname = 's'\n"
               "type = 'screw'\nbetween = ['nut', 'room']\naxis = [0, 1, 0]\npitch = 0.5\n",
       "s.pitch=0.3",
       {kIterative}},
      {"rail", kFlat + kRail, "way.friction=0", {kEvent}},
      {"rail_on_a_cart",
       kFlat +
           "[[ball]]\nname = 'ball'\nradius = 0.15\nposition = [1.5, 1.2]\n[[box]]\nname = 'cart'\n"
           "size = [2, 0.2]\nposition = [2, 0.3]\nmotion = { x = '0.2*sin(5*t)' }\n[[track]]\non = 'cart'\n"
           "points = [[-1, 1], { spline = [[0, 0.3], [1, 1]] }]\n",
       "ball.radius=0.1"},
      {"wire",
       kFlat +
           "[[particle]]\nname = 'bead'\nposition = [2.7, 1]\n[[track]]\nname = 'hoop'\nx = '2+0.8*cos(s)'\n"
           "y = '1.1+0.8*sin(s)'\nfrom = 0\nto = '2*pi'\nthread = ['bead']\nfriction = 0.1\n",
       "hoop.friction=0.4"},
      {"wire_in_space",
       kDeep +
           "[[particle]]\nname = 'bead'\nposition = [0.8, 2, 0]\n[[track]]\nx = '0.8*cos(s)'\ny = '2-0.1*s'\n"
           "z = '0.8*sin(s)'\nfrom = 0\nto = 18\nthread = ['bead']\nfriction = 0.1\n",
       "track[0].friction=0"},
      {"handout",
       "duration = 1\n[physics]\nrate = 240\ncollision = 'handout'\n[room]\nsize = [4, 2.25]\ndrag = 0.1\n"
       "[[box]]\nname = 'box'\nposition = [1, 1]\nvelocity = [2, 1]\n[[force]]\nname = 'f'\n"
       "components = ['-3*vx', 'sin(9*t)']\n[[mouse]]\npath = [[0.2, 1, 1], [0.7, 2, 1.5]]\n",
       "f.components=['0', '5']"},
      {"attractor",
       kFlat + "gravity = [0, 0]\ncoulomb = 1\n[[attractor]]\nname = 'sun'\nstrength = 1\ncenter = [2, 1]\n"
               "[[particle]]\nname = 'planet'\nposition = [1, 1]\nvelocity = [0, 1]\ncharge = 0.3\n"
               "copies = { count = 2, offset = [0.3, 0] }\n",
       "sun.strength=2",
       {kIterative, kEvent}},
      {"motors",
       kFlat + "[[box]]\nname = 'arm'\nsize = [0.6, 0.1]\nposition = [1, 1.2]\n[[box]]\nname = 'sled'\n"
               "size = [0.3, 0.2]\nposition = [3, 1]\n[[joint]]\nname = 'axle'\ntype = 'pin'\n"
               "between = ['arm', 'room']\nmotor = { angle = '90*sin(3*t)', most = 9 }\nfriction = 0.1\n"
               "[[joint]]\nname = 'guide'\ntype = 'slider'\nbetween = ['sled', 'room']\n"
               "motor = { position = '0.2*sin(4*t)', most = 9 }\nspring = { stiffness = 3, damping = 0.2 }\n",
       "axle.motor.most=0.1",
       {kIterative, kEvent}},
      {"gears_in_space",
       kDeep +
           "[[ball]]\nname = 'a'\nradius = 0.2\nposition = [-0.3, 1, 0]\n[[ball]]\nname = 'b'\nradius = 0.4\n"
           "position = [0.3, 1, 0]\n[[joint]]\nname = 'p'\ntype = 'hinge'\nbetween = ['a', 'room']\n"
           "motor = { speed = '90*t', most = 1 }\n[[joint]]\nname = 'q'\ntype = 'hinge'\n"
           "between = ['b', 'room']\n[[joint]]\ntype = 'gear'\njoints = ['p', 'q']\nratio = -2\n",
       "p.motor.most=0.001",
       {kIterative}},
      {"rail_in_space",
       kDeep + "[[ball]]\nname = 'ball'\nradius = 0.1\nposition = [-1, 1.62, 0]\n[[track]]\nname = 'left'\n"
               "points = [[-1.2, 1.6, 0.06], [1.5, 0.6, 0.06]]\n[[track]]\nname = 'right'\n"
               "points = [[-1.2, 1.6, -0.06], [1.5, 0.6, -0.06]]\n",
       "left.friction=0"},
      {"bonds",
       kFlat + "[[box]]\nname = 'piece'\nsize = [0.2, 0.2]\nposition = [1, 1.5]\n"
               "copies = { count = 3, offset = [0.2, 0] }\n[[bond]]\nname = 'glue'\nof = "
               "['piece[*]']\nbreaks = 30\n"
               "[[force]]\nname = 'f'\nof = 'piece[0]'\ncomponents = ['0', '1']\n"
               "[[when]]\nbreaks = 'glue'\ndo = [{ mark = 'snap' }]\n",
       "f.components=['2', '0']"},
      {"stops",
       kFlat + kBall +
           "[[when]]\ncrosses = { body = 'ball', from = [1.2, 0], to = [1.2, 2] }\ndo = [{ mark = 'gate' }]\n"
           "[[when]]\nleaves = ['ball', 'floor']\ndo = [{ mark = 'up' }]\n[[when]]\ntime = 0.9\n"
           "do = [{ stop = true }]\n",
       "ball.velocity=[2, 0]",
       {kIterative, kEvent}},
      {"events", kFlat + kEvents, "ball.velocity=[3, 0]", {kIterative, kEvent}},
  };
  static const std::vector<Feature> all = [] {
    std::vector<Feature> each;
    for (const Feature& it : written) {
      each.push_back(it);
      for (const std::string& line : it.physics) {
        const std::string head = "[physics]\n";
        std::string text = it.scene;
        text.insert(text.find(head) + head.size(), line + "\n");
        each.push_back({it.name + (line == kIterative ? "_iterative" : "_event"), text, it.set});
      }
    }
    return each;
  }();
  return all;
}

class Lecture : public Program, public ::testing::WithParamInterface<Feature> {
 protected:
  // runs it, and fails where it does not end well
  std::string good(const std::string& arguments) const {
    const Outcome run = obscura(arguments);
    EXPECT_EQ(run.exit, 0) << arguments << "\n" << run.out << run.err;
    return run.out;
  }
  static std::string last_row(const std::string& table) {
    std::istringstream lines(table);
    std::string line, last;
    while (std::getline(lines, line))
      if (!line.empty()) last = line;
    return last;
  }
  // the hash of the last row of a table of states
  static std::string hash(const std::string& table) {
    std::istringstream cells(last_row(table));
    std::string cell;
    for (int i = 0; i < 3; ++i) std::getline(cells, cell, ',');
    return cell;
  }
};

TEST_P(Lecture, GoesWithEverything) {
  scene(GetParam().scene);
  const std::string film = " --size 96x54 --fps 8 --progress none",
                    end = "states scene.toml --at 1 --format csv";
  const std::string set = " --set \"" + GetParam().set + "\"";
  const std::string row = last_row(good(end)), state = hash(row);
  ASSERT_EQ(state.size(), 32u) << state;

  // shards are the film, and a run goes on from its checkpoints
  good("render scene.toml -o a.mp4 --checkpoint-every 0.3" + film);
  good("render scene.toml -o b.mp4 --prepare 2" + film);
  good("render scene.toml -o b.mp4 --shard 2/2" + film);
  good("render scene.toml -o b.mp4 --shard 1/2" + film);
  good("join b.mp4");
  EXPECT_EQ(contents(path("a.mp4")), contents(path("b.mp4")));
  std::istringstream checkpoints(shell("find . -name '*.checkpoint'").out);
  int resumed = 0;
  for (std::string file; std::getline(checkpoints, file); ++resumed)
    EXPECT_EQ(last_row(good(end + " --from-checkpoint '" + file + "'")), row) << file;
  EXPECT_GT(resumed, 0);

  // --set and sweeps change one run alike
  const std::string other = hash(good(end + set));
  EXPECT_NE(other, state);
  EXPECT_NE(good("sweep scene.toml --vary \"" + GetParam().set + "\" --measure hash@end").find(other),
            std::string::npos);

  good("export scene.toml -o a.glb --fps 8");
  good("figure scene.toml -o a.svg --at 0.5");
  good("describe scene.toml");
  scene(GetParam().scene + "[golden]\nat = [0.5]\nsize = [96, 54]\n");
  good("golden scene.toml --references kept --update");
  good("golden scene.toml --references kept");
}

INSTANTIATE_TEST_SUITE_P(Features, Lecture, ::testing::ValuesIn(features()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace obscura::app
