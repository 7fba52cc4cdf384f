// obscura export: a run as one animated glTF, to be lit in another renderer.

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "app/commands/mesh.h"
#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/options.h"
#include "app/console/say.h"
#include "app/console/waiting.h"
#include "app/film/estimate.h"
#include "app/run/run_marks.h"
#include "app/run/trouble.h"
#include "draw/picture/joint_look.h"
#include "draw/picture/rope_way.h"
#include "draw/picture/theme.h"
#include "draw/picture/upright.h"
#include "media/error.h"
#include "media/file.h"
#include "media/glb.h"
#include "scene/scene.h"

namespace obscura::app {

namespace {

using media::Glb;
using sim::Vec3;

// sRGB to linear light
float linear(std::uint8_t c) {
  const double x = c / 255.0;
  return float(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

std::array<float, 4> linear(draw::Color c) { return {linear(c.r), linear(c.g), linear(c.b), 1}; }

std::array<float, 3> narrow(const Vec3& v) { return {float(v.x()), float(v.y()), float(v.z())}; }

// takes, of the two quaternions of an orientation, the one nearer to the previous: interpolation goes the
// short way
std::array<float, 4> narrow(Eigen::Quaterniond q, const std::vector<std::array<float, 4>>& before) {
  if (!before.empty()) {
    const auto& b = before.back();
    if (b[0] * q.x() + b[1] * q.y() + b[2] * q.z() + b[3] * q.w() < 0) q.coeffs() *= -1;
  }
  return {float(q.x()), float(q.y()), float(q.z()), float(q.w())};
}

// one value where all are one
template <class T>
void settle(std::vector<T>& values) {
  if (std::all_of(values.begin(), values.end(), [&](const T& each) { return each == values.front(); }))
    values.resize(std::min<std::size_t>(1, values.size()));
}

// meshes, each once, and the nodes that show them
class Stage {
 public:
  Stage(const scene::Scene& scene, const sim::SceneInfo& cast) : cast_(cast), depth_(cast.scale / 12) {
    glb.name = scene::one_line(scene.name), glb.generator = fmt::format("obscura {}", OBSCURA_VERSION);
    int next = 0;
    for (std::size_t i = 0; i < cast.bodies.size(); ++i) {
      const sim::SceneInfo::Body& body = cast.bodies[i];
      const auto own = i < scene.look.bodies.size() ? scene.look.bodies[i].color : std::nullopt;
      const draw::Color color = own          ? *own
                                : body.fixed ? draw::neutral(scene.look.theme)
                                             : draw::turn(next++);
      // a track without a body of another form is one
      const auto bare =
          std::find_if(cast.rails.begin(), cast.rails.end(),
                       [&](const sim::SceneInfo::Rail& rail) { return body.bare && rail.body == int(i); });
      Glb::Mesh mesh = bare == cast.rails.end() ? surface(body, depth_) : tube(bare->places, depth_ / 20);
      mesh.name = body.name, mesh.color = linear(color);
      add(body.name, std::move(mesh));
    }
    const draw::Palette palette = draw::palette(scene.look.theme);
    const auto rods = [&](std::size_t n, const std::string& name, draw::Color color) {
      for (std::size_t i = 0; i < n; ++i) {
        Glb::Mesh mesh = rod();
        mesh.name = name, mesh.color = linear(color);
        add(fmt::format("{}[{}]", name, i), std::move(mesh));
      }
    };
    rods(cast.springs.size(), "spring", palette.spring);
    for (const sim::SceneInfo::Joint& joint : cast.joints)
      if (far(joint)) rods(std::max<std::size_t>(2, joint.places.size()) - 1, joint.name, palette.ink);
    for (const sim::SceneInfo::Rail& rail : cast.rails) {
      if (!on_node(rail)) continue;
      Glb::Mesh mesh = tube(rail.places, depth_ / 20);
      mesh.name = rail.name, mesh.color = linear(palette.ink);
      add(rail.name, std::move(mesh));
    }
    for (const sim::SceneInfo::Wall& wall : cast.walls) {
      if (cast.dimension != 3 || wall.normal != Vec3::UnitY()) continue;
      Glb::Mesh mesh = floor(scene.extent.low, scene.extent.high);
      mesh.name = "floor", mesh.color = linear(palette.room);
      add("floor", std::move(mesh));
      glb.nodes.back().translations = {narrow(Vec3(0, wall.point.y(), 0))};
      break;
    }
  }

  void take(const sim::Snapshot& now) {
    glb.times.push_back(float(now.time));
    std::size_t node = 0;
    for (const auto& body : now.bodies) {
      Glb::Node& it = glb.nodes[node++];
      it.translations.push_back(narrow(body.position));
      it.rotations.push_back(narrow(body.orientation, it.rotations));
    }
    for (const auto& spring : now.springs) stretch(glb.nodes[node++], spring.a, spring.b, !spring.loose);
    std::vector<draw::RopeLine> lines;
    draw::RopeLine last;
    std::size_t line = 0;
    for (std::size_t i = 0; i < now.joints.size(); ++i) {
      if (!far(cast_.joints[i])) continue;
      const bool whole = !now.joints[i].broken;
      if (cast_.joints[i].places.empty()) stretch(glb.nodes[node++], now.joints[i].a, now.joints[i].b, whole);
      // what has left a wheel has fewer pieces, of the joints that are one
      const std::size_t its = cast_.joints[i].places.empty() ? 0 : cast_.joints[i].places.size() - 1;
      if (now.joints[i].with >= 0) lines = draw::rope_lines(cast_, i, now), line = 0;
      for (std::size_t k = 0; k < its; ++k) {
        const bool there = line < lines.size();
        if (there) last = lines[line++];
        stretch(glb.nodes[node++], last.from, last.to, whole && there);
      }
    }
    for (const sim::SceneInfo::Rail& rail : cast_.rails) {
      if (!on_node(rail)) continue;
      Glb::Node& it = glb.nodes[node++];
      const bool room = rail.body < 0;
      it.translations.push_back(
          narrow(room ? Vec3(Vec3::Zero()) : now.bodies[std::size_t(rail.body)].position));
      it.rotations.push_back(
          narrow(room ? Eigen::Quaterniond::Identity() : now.bodies[std::size_t(rail.body)].orientation,
                 it.rotations));
    }
  }

  void end() {
    for (Glb::Node& node : glb.nodes) settle(node.translations), settle(node.rotations), settle(node.scales);
  }

  Glb glb;

 private:
  // whether a track has a node of its own: one without another form has that of its body
  bool on_node(const sim::SceneInfo::Rail& rail) const {
    return rail.body < 0 || !cast_.bodies[std::size_t(rail.body)].bare;
  }

  static bool far(const sim::SceneInfo::Joint& joint) {
    return draw::spans(draw::joint_look(joint.kind).space);
  }

  void add(const std::string& name, Glb::Mesh mesh) {
    const auto same = std::find_if(glb.meshes.begin(), glb.meshes.end(), [&](const Glb::Mesh& each) {
      return each.color == mesh.color && each.triangles == mesh.triangles && each.positions == mesh.positions;
    });
    Glb::Node node;
    node.name = name, node.mesh = int(same - glb.meshes.begin());
    if (same == glb.meshes.end()) glb.meshes.push_back(std::move(mesh));
    glb.nodes.push_back(std::move(node));
  }

  // a rod from a to b; a broken one is too small to be seen
  void stretch(Glb::Node& node, const Vec3& a, const Vec3& b, bool whole) const {
    const Vec3 way = b - a;
    const double length = way.norm(), thick = whole ? depth_ / 20 : 0;
    node.translations.push_back(narrow(Vec3((a + b) / 2)));
    node.rotations.push_back(
        narrow(draw::turn_from_y(length > 0 ? way : Vec3(Vec3::UnitY())), node.rotations));
    node.scales.push_back(narrow(Vec3(thick, whole ? length : 0, thick)));
  }

  const sim::SceneInfo& cast_;
  double depth_;  // m
};

struct ExportFlags {
  std::string scene;
  std::optional<std::string> out, fps;
  std::vector<std::string> sets;
};

int run(const ExportFlags& flags) {
  const scene::Scene scene = with_run_marks(scene::read(flags.scene, flags.sets));
  warn_of_steps(scene);
  const sim::Rational fps = flags.fps ? parse_fps(*flags.fps) : scene.film.fps;
  const std::string out = flags.out.value_or(scene.name + ".glb");
  if (!out.ends_with(".glb"))
    throw UsageError(fmt::format("-o {}: expected a name that ends with .glb", out));

  const auto motion = scene.shown_run();
  motion->heed(interrupted);
  const std::int64_t frames = sim::ceil(scene.duration * fps);
  // a place and a turn of each node at each instant, in lists that grow, and then as a file
  const sim::SceneInfo& cast = motion->scene_info();
  const double nodes = double(cast.bodies.size() + cast.springs.size() + cast.joints.size());
  refuse_beyond_memory(scene, double(frames) * (nodes * 10 + 1) * sizeof(float) * 3);
  Stage stage(scene, motion->scene_info());
  for (std::int64_t n = 0; n <= frames; ++n) {
    const sim::Rational at = n < frames ? sim::rational(n) / fps : scene.duration;
    doing("simulating", double(n), double(frames), "frames");
    const auto outcome = motion->at(at);
    if (const auto* trouble = std::get_if<sim::Trouble>(&outcome))
      throw TroubleError(scene.file, *trouble, "");
    if (std::holds_alternative<sim::Stopped>(outcome)) return kInterrupted;
    stage.take(std::get<sim::Snapshot>(outcome));
  }
  stage.end();
  media::make_folder_of(out);
  media::write_glb(out, stage.glb);
  say(stdout, "{}: {} bodies, {} instants over {:g} s\n", out, motion->scene_info().bodies.size(), frames + 1,
      sim::value(scene.duration));
  return kDone;
}

}  // namespace

OBSCURA_COMMAND(90, export) {
  const Command command(program, exit, "export", "Write a run as one animated glTF, for another renderer");
  auto flags = std::make_shared<ExportFlags>();
  add_scene(command, flags->scene);
  command.option("-o,--output", flags->out, "The output, a name that ends with .glb [SCENE.glb]").type("OUT");
  command.option("--fps", flags->fps, "Instants per second [film.fps]").type("RATE");
  add_sets(command, flags->sets);
  add_memory_limit(command);
  command.footer(
      "One node per body, with its name, and a thin rod for each spring; metres, y up. At the instants the "
      "positions are those of the run; between them they are interpolated linearly.\n\n"
      "Examples:\n"
      "  obscura export scenes/room.toml\n"
      "  obscura export scenes/room.toml -o room.glb --fps 120");
  command.run([flags] { return run(*flags); });
}

}  // namespace obscura::app
