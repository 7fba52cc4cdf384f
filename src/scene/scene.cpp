#include "scene/scene.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>

#include "scene/bodies.h"
#include "scene/check.h"
#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/fields.h"
#include "scene/links.h"
#include "scene/overrides.h"
#include "scene/picture.h"
#include "scene/room.h"

namespace obscura::scene {

namespace {

sim::Integrator integrator(const std::string& word) {
  using enum sim::Integrator;
  return word == "midpoint"        ? midpoint
         : word == "euler"         ? euler
         : word == "semi-implicit" ? semi_implicit
                                   : rk4;
}

// springs, nets and mice share the bodies' names, for --set speaks of them all
void refuse_taken_names(const Node& top, const Roster& roster, Complaints& complaints) {
  std::map<std::string, Place> taken;
  for (const Group& group : roster.groups) taken.emplace(group.name, group.place);
  for (const char* kind : {"spring", "net", "mouse"}) {
    const Node* all = top.find(kind);
    for (std::size_t i = 0; all && i < all->list().size(); ++i) {
      const Node* name = all->list()[i].find("name");
      if (!name) continue;
      const auto [before, fresh] = taken.emplace(name->text(), name->place);
      if (!fresh)
        complaints.add(name->place, fmt::format("the name '{}' is taken at {}", name->text(),
                                                complaints.text(before->second)));
    }
  }
}

}  // namespace

Scene parse(const std::string& text, const std::string& file, const std::vector<std::string>& sets) {
  Complaints complaints(file, sets);
  Node top = document(text, file);
  if (top.table().empty())
    throw Error({{file, 0, 0, "has no keys at all; `obscura new NAME` writes a scene to start from"}});
  const std::vector<CopySet> copy_sets = apply(sets, top, complaints);
  check(top, complaints);

  Scene scene;
  scene.file = file;
  scene.name = file == "-" ? "scene" : std::filesystem::path(file).stem().string();
  scene.text = text;
  scene.sets = sets;
  const Fields words(top, "");
  scene.duration = words.rational("duration");
  scene.seed = std::uint64_t(std::get<std::int64_t>(words.node("seed").value));

  // what happens
  sim::Model<2>& model = scene.world.model;
  const Fields physics = Fields::of(top, "physics");
  model.rate = physics.rational("rate");
  model.integrator = integrator(physics.text("integrator"));
  model.gravity = Fields::of(top, "room").vector("gravity");
  const Room walls = room(top, complaints);
  model.walls = walls.walls;
  const Roster roster = bodies(top, walls, scene.seed, copy_sets, scene.world, scene.look.bodies, complaints);
  springs(top, roster, scene.world, complaints);
  nets(top, roster, scene.world, complaints);
  refuse_taken_names(top, roster, complaints);

  // what the camera fits, and with it the length of a reference pixel
  scene.extent = extent(walls, scene.world);
  model.scale = walls.height ? *walls.height : scene.extent.high.y() - scene.extent.low.y();
  mice(top, scene.world, complaints);

  // what it looks like, how it is filmed
  look(top, roster, scene.look, complaints);
  scene.camera = camera(top, complaints);
  scene.film = film(top);
  if (!complaints.none()) complaints.raise();
  return scene;
}

Scene read(const std::string& file, const std::vector<std::string>& sets) {
  return parse(contents(file), file, sets);
}

}  // namespace obscura::scene
