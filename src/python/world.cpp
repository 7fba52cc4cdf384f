// Worlds: states as columns of NumPy, which share the world's memory.

#include <pybind11/numpy.h>
#include <pybind11/operators.h>
#include <pybind11/stl.h>

#include <cstring>

#include "python/convert.h"

namespace obscura::python {

namespace py = pybind11;

namespace {

// rows of the state itself, for reading: the array keeps its world
py::array shared(const py::object& world, const Columns& of) {
  std::vector<py::ssize_t> shape{py::ssize_t(of.rows)};
  if (of.columns != 1) shape.push_back(py::ssize_t(of.columns));
  py::array_t<double> array(shape, of.first, world);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

std::span<const double> span(const Numbers& array) { return {array.data(), std::size_t(array.size())}; }

py::array_t<double> vector(const double (&x)[3]) { return py::array_t<double>(3, x); }

template <Columns (World::*Get)() const>
py::array column(const py::object& world) {
  return shared(world, (world.cast<const World&>().*Get)());
}
template <Columns (World::*Get)() const, void (World::*Set)(std::span<const double>)>
void set_column(const py::object& world, const py::object& given) {
  // columns for rows are as many numbers
  const py::array there = column<Get>(world);
  const Numbers to = numbers(given, "a column of " + shape(there));
  if (to.ndim() > 1 && to.size() == there.size() && shape(to) != shape(there))
    throw UsageError("an array of " + shape(to) + ", expected " + shape(there) + ": a row a body");
  (world.cast<World&>().*Set)(span(to));
}

}  // namespace

void add_world(py::module_& module) {
  py::class_<Contact> contact(module, "Contact", "Two that touch.");
  contact.def_readonly("body", &Contact::body, "The number of a body.")
      .def_readonly("other", &Contact::other, "The other body, or -1.")
      .def_readonly("wall", &Contact::wall,
                    "The wall, or -1: floor, left, right, ceiling, then the scene's own.")
      .def_readonly("gap", &Contact::gap, "m, negative: inside")
      .def_property_readonly(
          "point", [](const Contact& it) { return vector(it.point); }, "m")
      .def_property_readonly(
          "normal", [](const Contact& it) { return vector(it.normal); }, "Unit, towards the body.")
      .def_property_readonly(
          "force", [](const Contact& it) { return vector(it.force); }, "On the body, N.")
      .def_property_readonly(
          "impulse", [](const Contact& it) { return vector(it.impulse); },
          "On the body in the last step, N s.")
      .def_property_readonly("mode",
                             [](const Contact& it) {
                               constexpr const char* kModes[] = {"bouncing", "sliding", "sticking"};
                               return kModes[int(it.mode)];
                             })
      .def(pickled<Contact, &Contact::body, &Contact::other, &Contact::wall, &Contact::point,
                   &Contact::normal, &Contact::gap, &Contact::force, &Contact::impulse, &Contact::mode>());

  py::class_<Pair>(module, "Pair", "Two that touch, whichever of their features do.")
      .def_readonly("body", &Pair::body)
      .def_readonly("other", &Pair::other)
      .def_readonly("wall", &Pair::wall)
      .def(py::self == py::self)
      .def(pickled<Pair, &Pair::body, &Pair::other, &Pair::wall>())
      .def("__repr__", [](const Pair& it) {
        return "<Pair of body " + std::to_string(it.body) +
               (it.other >= 0 ? " and body " + std::to_string(it.other)
                              : " and wall " + std::to_string(it.wall)) +
               ">";
      });

  py::class_<Event>(module, "Event", "A condition of the scene that has fired.")
      .def_readonly("time", &Event::time, "s")
      .def_readonly("name", &Event::name)
      .def_readonly("what", &Event::what)
      .def_readonly("of", &Event::of)
      .def_readonly("marks", &Event::marks)
      .def_readonly("stop", &Event::stop)
      .def(
          pickled<Event, &Event::time, &Event::name, &Event::what, &Event::of, &Event::marks, &Event::stop>())
      .def("__repr__",
           [](const Event& it) { return "<Event " + it.name + " at " + std::to_string(it.time) + " s>"; });

  py::class_<Energies>(module, "Energies", "J")
      .def_readonly("kinetic", &Energies::kinetic)
      .def_readonly("gravity", &Energies::gravity)
      .def_readonly("springs", &Energies::springs)
      .def_readonly("fields", &Energies::fields)
      .def_readonly("work", &Energies::work)
      .def_readonly("total", &Energies::total)
      .def(pickled<Energies, &Energies::kinetic, &Energies::gravity, &Energies::springs, &Energies::fields,
                   &Energies::work, &Energies::total>())
      .def("__repr__",
           [](const Energies& it) { return "<Energies, " + std::to_string(it.total) + " J in all>"; });

  py::class_<State>(module, "State", "The whole state of a world, as a value: it compares and pickles.")
      .def(py::self == py::self)
      .def("__bytes__",
           [](const State& it) {
             return py::bytes(reinterpret_cast<const char*>(it.words.data()), it.words.size() * 8);
           })
      .def(py::pickle(
          [](const State& it) {
            return py::make_tuple(
                py::bytes(reinterpret_cast<const char*>(it.words.data()), it.words.size() * 8));
          },
          [](const py::tuple& saved) {
            const std::string bytes = saved[0].cast<std::string>();
            State state;
            state.words.resize(bytes.size() / 8);
            std::memcpy(state.words.data(), bytes.data(), state.words.size() * 8);
            return state;
          }));

  // Its attributes are those of the class in obscura/scene.py: with py::dynamic_attr() Python 3.11 would
  // count them twice, and never collect a world of a cycle.
  py::class_<World>(module, "World")
      .def(py::init([](const Scene& scene, int threads) {
             return unlocked([&] { return World(scene, threads); });
           }),
           py::arg("scene"), py::arg("threads") = 1)
      .def_property_readonly("time", &World::time, "s")
      .def_property_readonly("steps", &World::steps, "Done since the start.")
      .def_property_readonly("step_length", &World::step_length, "s")
      .def(
          "step", [](World& it, std::int64_t count) { unlocked([&] { it.step(count); }); },
          py::arg("count") = 1, "Goes on by so many steps of the physics clock.")
      .def(
          "step_to", [](World& it, double t) { unlocked([&] { it.step_to(t); }); }, py::arg("t"),
          "Goes on to the step that is nearest to t s; one that is past stays.")
      .def("body", &World::body, py::arg("name"), "The number of a body: its row in all columns.")
      .def_property("positions", &column<&World::positions>,
                    &set_column<&World::positions, &World::set_positions>,
                    "Centres of mass, m: a row a body.")
      .def_property("velocities", &column<&World::velocities>,
                    &set_column<&World::velocities, &World::set_velocities>, "m/s: a row a body.")
      .def_property("turns", &column<&World::turns>, &set_column<&World::turns, &World::set_turns>,
                    "Of bodies that turn, from first_turning on: angles, rad; in space quaternions of their "
                    "principal axes.")
      .def_property("spins", &column<&World::spins>, &set_column<&World::spins, &World::set_spins>,
                    "Of bodies that turn, rad/s: a number a body, in space a row.")
      .def_property_readonly("first_turning", &World::first_turning, "The first body that turns.")
      .def("read", &World::read, py::arg("quantity"),
           "A number of the state by its name: one of `quantities`.")
      .def_property_readonly("quantities", &World::quantities,
                             "The columns of `obscura states --format csv`.")
      .def_property_readonly("energies", &World::energies)
      .def_property_readonly("contacts", &World::contacts, "What touches now.")
      .def(
          "contact_changes",
          [](World& it) {
            const ContactChanges changes = it.contact_changes();
            return py::make_tuple(changes.began, changes.ended);
          },
          "Pairs that touch and did not at the last call, and pairs that did and do not.")
      .def_property_readonly("events", &World::events, "The scene's events that have fired.")
      .def("save", &World::save, "The whole state, as a value.")
      .def("restore", &World::restore, py::arg("state"), "Goes on from a state of this scene.")
      .def_property_readonly("hash", &World::hash, "Of the state: equal for equal runs, to the bit.");

  refuse_unmade<Contact>(), refuse_unmade<Pair>(), refuse_unmade<Event>(), refuse_unmade<Energies>();
  refuse_unmade<State>(), refuse_unmade<World>();
}

}  // namespace obscura::python
