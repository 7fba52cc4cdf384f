// Scenes, and forces of Python.

#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstring>
#include <memory>

#include "python/convert.h"

namespace obscura::python {

namespace py = pybind11;

namespace {

// Zeros whose memory a capsule owns: NumPy's resize(), which would move what the run reads, refuses such.
Numbers zeros(std::vector<py::ssize_t> shape) {
  std::size_t size = 1;
  for (const py::ssize_t each : shape) size *= std::size_t(each);
  auto* const memory = new double[size]();
  const py::capsule owner(memory, [](void* its) { delete[] static_cast<double*>(its); });
  return Numbers(std::move(shape), memory, owner);
}

// an array of its own: what Python keeps of a stage stays what it was
Numbers copied(const Columns& of, std::vector<py::ssize_t> shape) {
  Numbers array = zeros(std::move(shape));
  std::memcpy(array.mutable_data(), of.first, of.size() * sizeof(double));
  return array;
}

// An instant within a step, as Python's forces see it.
struct StageView {
  double time = 0;
  Numbers positions, velocities, spins, orientations, forces, torques;
};

// adds the answer of a force, if it returns one, forces or forces and torques, and not what it has filled
void add(const py::handle answer, Numbers& to, const char* what, const char* hint = "") {
  const Numbers given = numbers(answer, std::string("a force returned ") + what);
  if (given.size() != to.size())
    throw py::value_error(std::string("a force returned ") + std::to_string(given.size()) + " numbers of " +
                          what + ", expected " + std::to_string(to.size()) + hint);
  // columns for rows are as many numbers
  if (given.ndim() > 1 && shape(given) != shape(to))
    throw py::value_error(std::string("a force returned ") + what + " of " + shape(given) + ", expected " +
                          shape(to) + ": a row a body");
  if (py::isinstance<py::array>(answer)) {
    const auto* const its = static_cast<const double*>(py::reinterpret_borrow<py::array>(answer).data());
    if (its >= to.data() && its < to.data() + to.size()) return;
  }
  for (py::ssize_t i = 0; i < to.size(); ++i) to.mutable_data()[i] += given.data()[i];
}

// `stage.forces += f` sets what it has changed in place
template <Numbers StageView::*Of>
void set(StageView& stage, const py::object& given) {
  Numbers& its = stage.*Of;
  const Numbers to = numbers(given, "what a force fills");
  if (to.data() == its.data()) return;
  if (to.size() != its.size() || (to.ndim() > 1 && shape(to) != shape(its)))
    throw py::value_error("an array of " + shape(to) + ", expected " + shape(its) + ": a row a body");
  std::memcpy(its.mutable_data(), to.data(), std::size_t(its.nbytes()));
}

// The function of Python behind a force. Copies of it are in scenes, worlds and renderers of C++, where
// Python's collector does not look: a function that refers to its world would never be let go. So this has a
// weak reference to what holds the function, and the objects of Python keep that (obscura/scene.py). It may
// be let go in any thread.
struct Callable {
  explicit Callable(const py::object& holder)
      : held(new py::weakref(holder), [](py::weakref* it) {
          if (!Py_IsInitialized()) return;
          const py::gil_scoped_acquire locked;
          delete it;
        }) {}
  std::shared_ptr<py::weakref> held;

  py::object called(const StageView& view) const {
    const py::object holder = (*held)();
    if (holder.is_none()) throw UsageError("the function of a force is gone");
    try {
      return holder.attr("function")(view);
    } catch (py::error_already_set& error) {
      // it would end the loop over frames in which the force is called
      if (!error.matches(PyExc_StopIteration)) throw;
      py::raise_from(error, PyExc_RuntimeError, "a force raised StopIteration");
      throw py::error_already_set();
    }
  }

  void operator()(const Stage& stage, const Push& push) const {
    const py::gil_scoped_acquire locked;
    const auto n = py::ssize_t(stage.positions.rows), d = py::ssize_t(stage.positions.columns);
    const auto spins = py::ssize_t(stage.spins.columns);
    const auto rows = [&](py::ssize_t columns) {
      return columns == 1 ? std::vector<py::ssize_t>{n} : std::vector<py::ssize_t>{n, columns};
    };
    StageView view{stage.time,
                   copied(stage.positions, {n, d}),
                   copied(stage.velocities, {n, d}),
                   copied(stage.spins, rows(spins)),
                   copied(stage.orientations, {n, d, d}),
                   zeros(rows(d)),
                   zeros(rows(spins))};
    Numbers forces = view.forces, torques = view.torques;
    const py::object answer = called(view);
    if (py::isinstance<py::tuple>(answer) && py::len(answer) == 2) {
      constexpr const char* kHint = ": a tuple of two is forces and torques";
      add(answer[py::int_(0)], forces, "forces", kHint), add(answer[py::int_(1)], torques, "torques", kHint);
    } else if (!answer.is_none()) {
      add(answer, forces, "forces");
    }
    std::memcpy(push.forces, forces.data(), std::size_t(forces.nbytes()));
    std::memcpy(push.torques, torques.data(), std::size_t(torques.nbytes()));
  }
};

}  // namespace

void add_scene(py::module_& module) {
  py::class_<StageView>(module, "Stage", "All bodies at an instant within a step, as a force is given them.")
      .def_readonly("time", &StageView::time, "s")
      .def_readonly("positions", &StageView::positions, "Centres of mass, m: a row a body.")
      .def_readonly("velocities", &StageView::velocities, "m/s: a row a body.")
      .def_readonly("spins", &StageView::spins, "rad/s: a number a body, in space a row.")
      .def_readonly("orientations", &StageView::orientations,
                    "Matrices that turn a body's axes into the room's: orientations[i] @ local.")
      .def_property(
          "forces", [](const StageView& it) { return it.forces; }, &set<&StageView::forces>,
          "What the force fills, N: a row a body, all zero before.")
      .def_property(
          "torques", [](const StageView& it) { return it.torques; }, &set<&StageView::torques>,
          "Likewise, N m about the centres of mass.");

  py::class_<Body>(module, "Body", "One body of a scene.")
      .def_readonly("name", &Body::name)
      .def_readonly("kind", &Body::kind, "Its form: 'point', 'ball', 'box', ...")
      .def_readonly("mass", &Body::mass, "kg")
      .def_readonly("fixed", &Body::fixed)
      .def_readonly("turns", &Body::turns)
      .def("__repr__", [](const Body& it) { return "<Body " + it.name + ", a " + it.kind + ">"; });

  py::class_<Scene>(module, "Scene")
      .def(py::init<const Scene&>())
      .def_static(
          "read",
          [](const std::string& file, const std::vector<std::string>& sets) {
            return unlocked([&] { return Scene::read(file, sets); });
          },
          py::arg("file"), py::arg("sets") = std::vector<std::string>())
      .def_static(
          "parse",
          [](const std::string& text, const std::string& name, const std::vector<std::string>& sets) {
            return unlocked([&] { return Scene::parse(text, name, sets); });
          },
          py::arg("text"), py::arg("name") = "scene.toml", py::arg("sets") = std::vector<std::string>())
      .def_static(
          "build",
          [](const py::handle& keys, const std::string& name) { return Builder(table(keys)).build(name); },
          py::arg("keys"), py::arg("name") = "scene")
      .def("with_force", [](const Scene& it, const std::string& name,
                            const py::object& holder) { return it.with_force(name, Callable(holder)); })
      .def("keys", [](const Scene& it) { return dict(it.keys()); })
      .def_property_readonly("name", &Scene::name)
      .def_property_readonly("file", &Scene::file)
      .def_property_readonly("text", &Scene::text)
      .def_property_readonly("sets", &Scene::sets)
      .def_property_readonly("duration", &Scene::duration)
      .def_property_readonly("dimension", &Scene::dimension)
      .def_property_readonly("bodies", &Scene::bodies)
      .def_property_readonly("forces", &Scene::forces)
      .def_property_readonly("warnings", &Scene::warnings)
      .def_property_readonly("hash", &Scene::hash);

  refuse_unmade<StageView>(), refuse_unmade<Body>(), refuse_unmade<Scene>();

  module.def(
      "toml", [](const py::handle& keys) { return Builder(table(keys)).text(); }, "A scene's keys as TOML.");
  module.def("check_key",
             [](const std::string& path, const py::handle& to) { Builder().set(path, value(to)); });
  module.def("schema", &schema, "The scene language's JSON Schema, as text.");
}

}  // namespace obscura::python
