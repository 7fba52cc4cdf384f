#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <thread>

#include "draw/compose/annotate.h"
#include "scene/bodies.h"
#include "scene/body_kinds.h"
#include "scene/bonds.h"
#include "scene/chains.h"
#include "scene/check.h"
#include "scene/complaints.h"
#include "scene/dimension.h"
#include "scene/document.h"
#include "scene/explosions.h"
#include "scene/fields.h"
#include "scene/figure.h"
#include "scene/forces.h"
#include "scene/idle_keys.h"
#include "scene/input.h"
#include "scene/joints.h"
#include "scene/links.h"
#include "scene/overlap.h"
#include "scene/overrides.h"
#include "scene/path.h"
#include "scene/picture.h"
#include "scene/room.h"
#include "scene/tracks.h"
#include "scene/whens.h"
#include "sim/constraint/joints/joint.h"
#include "sim/constraint/material.h"
#include "sim/math/trig.h"
#include "sim/math/workers.h"
#include "sim/motion/infinitesimal_motion.h"
#include "sim/motion/stability.h"
#include "sim/solve/contact_solver.h"
#include "sim/solve/exact/couples.h"
#include "sim/step/observer.h"

namespace obscura::scene {

namespace {

sim::Integrator integrator(const std::string& word) {
  using enum sim::Integrator;
  return word == "midpoint"        ? midpoint
         : word == "euler"         ? euler
         : word == "semi-implicit" ? semi_implicit
                                   : rk4;
}

sim::Collision collision(const std::string& word) {
  using enum sim::Collision;
  return word == "contact" ? contact : word == "event" ? event : handout;
}

sim::Solver solver(const std::string& word) {
  const auto all = sim::solver_kinds();
  const auto found = std::ranges::find(all, word, &sim::SolverKind::name);
  return found == all.end() ? sim::Solver::automatic : found->kind;
}

// the handout knows particles and boxes, each alone
void refuse_beyond_handout(const Node& top, int dimension, Diagnostics& complaints) {
  std::vector<std::string_view> kinds;
  for (const BodyKind& kind : body_kinds())
    if (dimension == 2 && kind.dimension != 3 && !kind.handout) kinds.push_back(kind.name);
  kinds.push_back("joint"), kinds.push_back("chain"), kinds.push_back("track");
  for (const std::string_view kind : kinds) {
    const Node* all = top.find(kind);
    if (!all || all->list().empty()) continue;
    complaints.add(all->list().front().place,
                   fmt::format("[[{}]] is not in `collision = \"handout\"`, which knows particles and boxes; "
                               "[physics] collision = \"contact\" has it",
                               kind));
  }
}

// The groups that a word of contact.ignore means: one that bodies have as their `group`, or those of bodies
// of that name, which are made for them where they have none.
template <int D>
std::vector<int> groups_of(const Node& word, NameTable& roster, sim::Model<D>& model,
                           Diagnostics& complaints) {
  const std::string& text = word.text();
  if (const auto found = roster.families.find(text); found != roster.families.end()) return {found->second};
  const auto its = reference(text);
  if (!roster.index.contains(text) && !(its && its->bracketed && roster.index.contains(its->name))) {
    std::vector<std::string_view> words;
    for (const auto& [name, number] : roster.families) words.push_back(name);
    for (const Group& group : roster.groups) words.push_back(group.name);
    complaints.add(word.place, fmt::format("no group or body is called {}{}", scene::in_quotes(text),
                                           did_you_mean(text, words)));
    return {};
  }
  const auto whole = roster.index.find(text);
  const std::string all =
      whole == roster.index.end() || roster.groups[std::size_t(whole->second)].grid.empty() ? text
                                                                                            : text + "[*]";
  const std::vector<int> bodies = roster.bodies(all, word.place, complaints);
  std::vector<int> groups;
  int fresh = 0;
  for (const int body : bodies) {
    int& group = model.bodies[std::size_t(body)].group;
    if (group == 0) {
      if (fresh == 0) fresh = roster.families.emplace(text, int(roster.families.size()) + 1).first->second;
      group = fresh;
    }
    groups.push_back(group);
  }
  std::sort(groups.begin(), groups.end());
  groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
  // others of these groups would be let through as well
  for (int body = 0; body < int(model.bodies.size()); ++body) {
    if (!std::binary_search(groups.begin(), groups.end(), model.bodies[std::size_t(body)].group) ||
        std::find(bodies.begin(), bodies.end(), body) != bodies.end())
      continue;
    complaints.add(word.place,
                   fmt::format("{} is of a group with '{}', and a body has one group; give 'group' "
                               "to what [contact] ignore names",
                               scene::in_quotes(text), model.bodies[std::size_t(body)].name));
    return {};
  }
  return groups;
}

// groups that do not touch, as the bodies number them
template <int D>
void ignore(const Node& top, NameTable& roster, sim::Model<D>& model, Diagnostics& complaints) {
  const Fields contact = Fields::of(top, "contact");
  for (const Node& pair : contact.node("ignore").list()) {
    const std::vector<int> one = groups_of(pair.list()[0], roster, model, complaints),
                           other = groups_of(pair.list()[1], roster, model, complaints);
    for (const int a : one)
      for (const int b : other) model.ignore.emplace_back(a, b);
  }
}

// bonded bodies move as their bonds say
template <int D>
void refuse_moved_bonds(const Node& top, const sim::Model<D>& model, Diagnostics& complaints) {
  if (model.bonds.empty()) return;
  for (const sim::Joint<D>& joint : model.joints) {
    if (!sim::equations<D>(joint.kind).mechanism) continue;
    complaints.add(
        top.find("bond")->list().front().place,
        "a scene has [[bond]]s or pulleys and gears, not both yet; a [[joint]] of type \"weld\" with "
        "'breaks' holds two bodies together");
    return;
  }
  const auto carries = [](const sim::Body<D>& body) { return body.carries(); };
  if (model.drives.empty() && std::none_of(model.bodies.begin(), model.bodies.end(), carries)) return;
  complaints.add(top.find("bond")->list().front().place,
                 "a scene has [[bond]]s or bodies with 'motion', 'release' or 'surface_speed', not both yet; "
                 "a [[joint]] of type \"weld\" with 'breaks' holds two bodies together");
}

// springs, nets, joints and mice share the bodies' names, for --set speaks of them all
void refuse_taken_names(const Node& top, const NameTable& roster, Diagnostics& complaints) {
  std::map<std::string, Place> taken;
  for (const Group& group : roster.groups) taken.emplace(group.name, group.place);
  for (const char* kind : {"spring", "net", "joint", "chain", "bond", "explosion", "force", "attractor",
                           "mouse", "when", "track"}) {
    const Node* all = top.find(kind);
    for (std::size_t i = 0; all && i < all->list().size(); ++i) {
      const Node* name = all->list()[i].find("name");
      if (!name) continue;
      const auto [before, fresh] = taken.emplace(name->text(), name->place);
      if (!fresh && before->second != name->place)
        complaints.add(name->place, fmt::format("the name '{}' is taken at {}", name->text(),
                                                complaints.text(before->second)));
    }
  }
}

// the direct solver looks at every couple of bodies
template <int D>
void refuse_crowd(const Node& top, const sim::Model<D>& model, Diagnostics& complaints) {
  if (model.collision == sim::Collision::handout || sim::solver(model) != sim::Solver::direct) return;
  const double all = sim::couples(model);
  if (all <= sim::kMostCouples) return;
  const Fields physics = Fields::of(top, "physics");
  const bool event = model.collision == sim::Collision::event;
  const Place where = physics.place(event ? "collision" : "solver");
  complaints.add(
      where, fmt::format("the direct solver looks at all pairs of bodies and walls, {:.0f} here, and takes "
                         "{:.0f} at most; {}",
                         all, sim::kMostCouples,
                         event ? "collision = \"contact\" is for thousands of bodies"
                               : "leave 'solver' out: the iterative one is for thousands of bodies"));
}

// what slips otherwise than it rests is the direct solver's
template <int D>
void check_static_friction(const Node& top, const sim::Model<D>& model, Diagnostics& complaints) {
  if (!sim::has_static_friction(model)) return;
  const Fields physics = Fields::of(top, "physics");
  const bool handout = model.collision == sim::Collision::handout;
  if (handout || sim::solver(model) != sim::Solver::direct)
    complaints.add(physics.place(handout ? "collision" : "solver"),
                   handout ? "the handout has no friction, and so no 'static_friction'"
                           : "'static_friction' is for the direct solver; write solver = \"direct\"");
}

template <int D>
sim::World<D> built(const Node& top, const std::vector<CopySet>& copy_sets, const Dimension& told,
                    Scene& scene, Diagnostics& complaints, bool events = true);

// the model of the same scene with one more key set
template <int D>
std::optional<sim::Model<D>> rebuilt(const Node& top, const std::vector<CopySet>& copy_sets,
                                     const Dimension& told, const std::string& set, Place place,
                                     Diagnostics& complaints) {
  if (!complaints.none()) return {};
  Node other = top;
  Diagnostics own = complaints;
  std::vector<CopySet> sets = apply({set}, other, own);
  sets.insert(sets.begin(), copy_sets.begin(), copy_sets.end());
  check(other, told, own);
  Scene unseen;
  std::optional<sim::Model<D>> model;
  if (own.none()) model = built<D>(other, sets, told, unseen, own, false).model;
  if (own.none()) return model;
  complaints.add(place, fmt::format("'set': {}", own.first()));
  return {};
}

// the body that sees the room, around which that would have to turn
template <int D>
int observer(const Node& top, const NameTable& roster, const sim::Model<D>& model, Diagnostics& complaints) {
  const Node* its = Fields::of(top, "room").given("observer");
  if (!its || (its->text() == "room" && roster.index.count("room") == 0)) return -1;
  const std::vector<int> found = roster.bodies(its->text(), its->place, complaints);
  if (found.size() > 1)
    complaints.add(its->place, fmt::format("{} is {} bodies; one sees the room", scene::in_quotes(its->text()),
                                           found.size()));
  const auto refuse = [&](bool any, const char* what) {
    if (any) complaints.add(its->place, fmt::format("an observer sees a room without {}", what));
  };
  refuse(!model.walls.empty(), "walls, which stand still; write walls = \"none\", and fixed boxes for them");
  refuse(top.find("mouse") != nullptr, "mice");
  refuse(top.find("explosion") != nullptr, "explosions");
  refuse(Fields::of(top, "room").given("fluid") != nullptr, "a fluid");
  return found.size() == 1 ? found[0] : -1;
}

// builds the world, in the plane or in space, and its looks
template <int D>
sim::World<D> built(const Node& top, const std::vector<CopySet>& copy_sets, const Dimension& told,
                    Scene& scene, Diagnostics& complaints, bool events) {
  sim::World<D> world;
  sim::Model<D>& model = world.model;
  const Fields physics = Fields::of(top, "physics");
  model.rate = physics.rational("rate");
  model.integrator = integrator(physics.text("integrator"));
  model.collision = collision(physics.text("collision"));
  model.solver = solver(physics.text("solver"));
  model.impacts =
      physics.text("impacts") == "sequential" ? sim::Impacts::sequential : sim::Impacts::simultaneous;
  model.overlap = physics.text("overlap") == "separate" ? sim::Overlap::separate : sim::Overlap::refuse;
  model.gravity = Fields::of(top, "room").vector<D>("gravity");
  const Room<D> walls = room<D>(top, complaints);
  model.walls = walls.walls;
  Constants constants(top, complaints);
  Seating<D> roster =
      bodies<D>(top, walls, scene.seed, copy_sets, told, constants, world, scene.look.bodies, complaints);
  tracks(top, constants, roster, world, scene.look, complaints);
  for (const Seat<D>& seat : roster.seats) scene.axes.push_back(sim::quaternion<D>(seat.axes));
  ready_to_let_go(top, roster, constants, world, complaints);
  const std::vector<NameRange> sprung = springs(top, roster, world, complaints);
  nets(top, roster, world, complaints);
  joints(top, roster, constants, world, complaints);
  chains(top, roster, world, complaints);
  explosions(top, model, complaints);
  forces(top, constants, roster, world, complaints);
  const std::vector<NameRange> bonded = bonds(top, roster, world, complaints);
  refuse_moved_bonds(top, model, complaints);
  ignore(top, roster, model, complaints);
  refuse_off_tracks(top, model, complaints);
  const Rebuild<D> rebuild = [&](const std::string& set, Place place, Diagnostics& wrong) {
    return rebuilt<D>(top, copy_sets, told, set, place, wrong);
  };
  if (events && whens<D>(top, roster, sprung, bonded, constants, rebuild, world, complaints))
    constants.refuse_unused();
  if (model.collision == sim::Collision::handout) refuse_beyond_handout(top, D, complaints);
  refuse_crowd(top, model, complaints);
  check_static_friction(top, model, complaints);
  refuse_taken_names(top, roster, complaints);

  scene.observer = observer(top, roster, model, complaints);

  // the extent that the camera fits; it sets the length of a reference pixel
  scene.extent = extent(walls, world);
  model.scale = walls.height ? *walls.height : scene.extent.high.y() - scene.extent.low.y();
  mice(top, world, complaints);

  // the looks
  look(top, roster, scene.look, complaints);
  scene.cameras = cameras<D>(top, roster, complaints);
  const WhenNames<D> names{top, roster, sprung, bonded, model, constants, complaints};
  scene.figure = figure<D>(names, roster, world, complaints);
  scene.film.marks = film_marks<D>(names, roster, world, scene.film.speed, complaints);
  scene.figure.names = scene.film.marks.names = draw::names_of(scene.look);
  for (auto* vectors : {&scene.figure.vectors, &scene.film.marks.vectors})
    for (draw::Marks::Vector& vector : *vectors)
      vector.quiet = std::size_t(vector.body) < scene.look.bodies.size() &&
                     scene.look.bodies[std::size_t(vector.body)].quiet;
  scene.film.titles.captions = captions<D>(top, roster, world, scene.film.speed, complaints);
  scene.film.charts = charts<D>(top, roster, world, complaints);
  refuse_low_plots(top, scene.figure, scene.film, scene.look.type_scale, complaints);

  // overlaps may follow from other errors: report them only if there are none, and once
  if (events && complaints.none() && model.collision != sim::Collision::handout)
    refuse_overlaps(roster, world, complaints);
  return world;
}

}  // namespace

Scene::Scene() = default;
Scene::Scene(const Scene&) = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(const Scene&) = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

Scene parse(const std::string& text, const std::string& file, const std::vector<std::string>& sets,
            const RunMarks* marks) {
  Diagnostics complaints(file, sets);
  Node top = document(text, file);
  if (top.table().empty())
    throw Error({{file, 0, 0, "has no keys at all; `obscura new NAME` writes a scene to start from"}});
  const std::vector<CopySet> copy_sets = apply(sets, top, complaints);
  const Dimension told = dimension(top);
  check(top, told, complaints);
  if (complaints.none()) refuse_idle_keys(top, copy_sets, complaints);

  Scene scene;
  MarksPut put = put_marks(top, marks, complaints);
  scene.marks = std::move(put.used), scene.figure_waits = put.figure_waits;
  scene.marked = marks != nullptr;
  scene.file = file;
  scene.name = file == "-" ? "scene" : std::filesystem::path(file).stem().string();
  scene.text = text;
  scene.sets = sets;
  const Fields words(top, "");
  scene.duration = words.rational("duration");
  scene.seed = std::uint64_t(std::get<std::int64_t>(words.node("seed").value));

  scene.show_divergence = Fields::of(top, "physics").text("diverge") == "show";
  scene.film = film(top, complaints);
  if (told.n == 3 && scene.film.over)
    complaints.add(Fields::of(top, "film").place("vary_place"),
                   "runs in space are shown beside each other: leave 'vary_place' out");
  scene.golden = golden(top, scene.duration, complaints);
  if (told.n == 2)
    scene.world = built<2>(top, copy_sets, told, scene, complaints);
  else
    scene.world = built<3>(top, copy_sets, told, scene, complaints);
  if (!complaints.none()) complaints.raise();
  return scene;
}

std::unique_ptr<sim::Run> Scene::run(std::span<const std::uint64_t> saved) const {
  const auto run = [&]<int D>(const sim::World<D>& it) {
    auto found = trajectory ? sim::playback(it, trajectory) : sim::run(it, saved);
    if (observer < 0 || !found) return found;
    const sim::Orientation<D> turn = turn_of(it, observer);
    const double angle = D == 2 ? turn[0] : 0;
    return sim::seen_from(std::move(found), observer, sim::to_3d<D>(it.state.x[std::size_t(observer)]),
                          sim::quaternion<D>(turn), angle);
  };
  return std::visit(run, world);
}

std::unique_ptr<sim::Run> Scene::shown_run(std::span<const std::uint64_t> saved) const {
  auto found = run(saved);
  if (found && show_divergence) found->show_divergence();
  return found;
}

Scene Scene::again(const std::vector<std::string>& other, const RunMarks* with) const {
  Scene next = parse(text, file, other, with);
  const auto keep = [&]<int D>(const sim::World<D>& from) {
    for (const sim::Force<D>& force : from.model.forces)
      if (force.function) next.add_force<D>(force.name, *force.function);
  };
  if (next.dimension() == dimension()) std::visit(keep, world);
  const auto workers = std::visit([](const auto& from) { return from.model.workers; }, world);
  std::visit([&](auto& to) { to.model.workers = workers; }, next.world);
  return next;
}

void Scene::share_steps(int threads) {
  constexpr int kBodiesEach = 50;  // fewer are not worth a thread
  if (threads <= 0) threads = std::max(1, int(std::thread::hardware_concurrency()));
  const auto share = [&](auto& it) {
    const bool many = sim::solver(it.model) == sim::Solver::iterative;
    const int useful = std::min(threads, many ? int(it.model.bodies.size()) / kBodiesEach : 1);
    it.model.workers = useful > 1 ? std::make_shared<sim::Workers>(useful) : nullptr;
  };
  std::visit(share, world);
}

template <int D>
void Scene::add_force(const std::string& called, sim::ForceFunction<D> function) {
  sim::Model<D>& model = std::get<sim::World<D>>(world).model;
  sim::Force<D> force;
  force.name = called;
  force.on = sim::Force<D>::On::among, force.law = sim::Force<D>::Law::function;
  force.function = std::make_shared<const sim::ForceFunction<D>>(std::move(function));
  for (int i = 0; i < int(model.bodies.size()); ++i) force.subjects.push_back({.body = i});
  model.forces.push_back(std::move(force));
}
template void Scene::add_force<2>(const std::string&, sim::ForceFunction<2>);
template void Scene::add_force<3>(const std::string&, sim::ForceFunction<3>);

std::vector<std::string> Scene::programs() const {
  std::vector<std::string> names;
  std::visit(
      [&](const auto& of) {
        for (const auto& force : of.model.forces)
          if (force.function) names.push_back(force.name);
      },
      world);
  return names;
}

std::vector<sim::Trouble> Scene::stability_warnings() const {
  return std::visit(
      [](const auto& it) {
        std::vector<sim::Trouble> all = sim::stability_warnings(it.model);
        for (sim::Trouble& each : sim::infinitesimal_motions(it.model, it.state))
          all.push_back(std::move(each));
        return all;
      },
      world);
}

Scene read(const std::string& file, const std::vector<std::string>& sets) {
  try {
    return parse(contents(file), file, sets);
  } catch (const Error&) {
    stop_if_asked();
    throw;
  }
}

}  // namespace obscura::scene
