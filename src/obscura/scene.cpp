#include <fmt/format.h>

#include <memory>

#include "app/run/origin.h"
#include "app/run/trouble.h"
#include "obscura/inside.h"
#include "scene/canonical.h"
#include "scene/complaints.h"
#include "sim/step/snapshots.h"

namespace obscura {

namespace {

const char* kind_name(sim::ShapeKind kind) {
  constexpr const char* kNames[] = {"point", "ball", "box", "polygon", "compound", "capsule", "hull"};
  return kNames[int(kind)];
}

Scene wrapped(scene::Scene scene) {
  auto inside = std::make_shared<Scene::Inside>();
  std::visit(
      [&]<int D>(const sim::World<D>& world) {
        std::vector<sim::Path<D>> paths;
        for (const auto& mouse : world.model.mice) paths.emplace_back(mouse.path);
        for (const sim::SceneInfo::Body& body : sim::cast(world.model, world.state, paths).bodies)
          inside->bodies.push_back({body.name, kind_name(body.kind), body.mass, body.fixed, body.turns});
      },
      scene.world);
  inside->scene = std::move(scene);
  return Scene(std::move(inside));
}

Value value_of(const scene::Node& node) {
  struct Visitor {
    Value operator()(std::int64_t x) const { return x; }
    Value operator()(double x) const { return x; }
    Value operator()(bool x) const { return x; }
    Value operator()(const std::string& text) const { return text; }
    Value operator()(const scene::Node::Date&) const { return "a date"; }
    Value operator()(const scene::Node::List& list) const {
      Value::List all;
      for (const scene::Node& each : list) all.push_back(value_of(each));
      return all;
    }
    Value operator()(const scene::Node::Table& table) const {
      Table all;
      for (const scene::Entry& each : table) all.emplace_back(each.key, value_of(each.node));
      return all;
    }
  };
  return std::visit(Visitor{}, node.value);
}

// A force of the interface as the physics calls it. Runs in several threads call one: what it fills is the
// thread's own.
template <int D>
sim::ForceFunction<D> called(Force force, std::vector<Eigen::Quaterniond> axes) {
  std::vector<Eigen::Matrix<double, D, D>> own;
  for (const Eigen::Quaterniond& each : axes)
    own.push_back(each.conjugate().toRotationMatrix().topLeftCorner<D, D>());
  return [force = std::move(force), own = std::move(own)](const sim::ForceStage<D>& at,
                                                          std::vector<sim::Vec<D>>& forces,
                                                          std::vector<sim::AngularVec<D>>& torques) {
    using Rows = Eigen::Matrix<double, D, D, Eigen::RowMajor>;
    const std::size_t n = at.x.size();
    if (n == 0) return;
    thread_local std::vector<Rows> orientations;
    orientations.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      orientations[i] = D == 2 ? Rows(at.room_from_body[i]) : Rows(at.room_from_body[i] * own[i]);
    const auto columns = [n](const auto& rows) {
      return Columns{rows[0].data(), n, std::size_t(rows[0].size())};
    };
    force({at.time, columns(at.x), columns(at.v), columns(at.w), columns(orientations)},
          {forces[0].data(), torques[0].data()});
  };
}

}  // namespace

Scene Scene::read(const std::string& file, const std::vector<std::string>& sets) {
  return guarded([&] { return wrapped(scene::read(file, sets)); });
}

Scene Scene::parse(const std::string& text, const std::string& name, const std::vector<std::string>& sets) {
  return guarded([&] { return wrapped(scene::parse(text, name, sets)); });
}

Scene Scene::with(std::string_view key, const Value& value) const {
  if (key.find('=') != key.npos)
    throw UsageError(fmt::format("with: the key {} has a value of its own", scene::in_quotes(key)));
  return guarded([&] {
    std::vector<std::string> sets = inside().scene.sets;
    sets.push_back(std::string(key) + "=" + literal(value));
    return wrapped(inside().scene.again(sets));
  });
}

Scene Scene::with_force(const std::string& name, Force force) const {
  if (!force) throw UsageError("with_force: there is no function");
  scene::Scene next = inside().scene;
  if (next.trajectory) throw UsageError("with_force: another program's run has forces of its own");
  std::visit(
      [&]<int D>(const sim::World<D>& world) {
        if (!world.model.bonds.empty())
          throw UsageError("with_force: a scene has [[bond]]s or forces of a program, not both yet");
        for (const sim::Force<D>& each : world.model.forces)
          if (each.name == name) throw UsageError("with_force: the name '" + name + "' is taken");
      },
      next.world);
  const auto axes = next.axes;
  if (next.dimension() == 2)
    next.add_force<2>(name, called<2>(std::move(force), axes));
  else
    next.add_force<3>(name, called<3>(std::move(force), axes));
  return wrapped(std::move(next));
}

const std::string& Scene::name() const { return inside().scene.name; }
const std::string& Scene::file() const { return inside().scene.file; }
const std::string& Scene::text() const { return inside().scene.text; }
const std::vector<std::string>& Scene::sets() const { return inside().scene.sets; }
double Scene::duration() const { return sim::value(inside().scene.duration); }
int Scene::dimension() const { return inside().scene.dimension(); }
const std::vector<Body>& Scene::bodies() const { return inside().bodies; }
std::vector<std::string> Scene::forces() const { return inside().scene.programs(); }

std::vector<std::string> Scene::warnings() const {
  std::vector<std::string> all;
  for (const sim::Trouble& each : inside().scene.stability_warnings()) all.push_back(each.likely);
  return all;
}

Table Scene::keys() const {
  return guarded([&] {
    const scene::Node top = scene::with_sets({text(), sets()});
    return std::get<Table>(value_of(top).is);
  });
}

std::string Scene::hash() const {
  return guarded([&] { return app::hash(scene::canonical({text(), sets()})); });
}

}  // namespace obscura
