#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <type_traits>

#include "obscura/obscura.h"

namespace obscura::python {

/// A value of Python as one of the scene language: numbers, truths, text, paths, sequences, arrays and
/// mappings. Throws TypeError for others, with the key, and for what is nested deeper than a scene can be.
Value value(pybind11::handle from, int depth = 0);
Table table(pybind11::handle from, int depth = 0);

/// The same back: numbers, text, lists and dicts.
pybind11::object object(const Value& from);
pybind11::dict dict(const Table& from);

/// "2 x 5": an array's shape in messages.
std::string shape(const pybind11::array& of);

using Numbers = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;
/// An array, or what becomes one, of real numbers. Throws TypeError for what is none, and for text and
/// complex numbers; `what` begins the message: "a force returned forces: no array of numbers: 'a'".
Numbers numbers(pybind11::handle from, const std::string& what);

/// "'a'", "[1, 2, ...": a value in messages, cut where it is long.
std::string shown(pybind11::handle value);

/// Refuses objects whose __init__ has not run, as T.__new__(T) makes them. Memory for the C++ object is then
/// taken when it is first used, and would be read without having been written: what takes it throws instead.
template <class T>
void refuse_unmade() {
  pybind11::detail::get_type_info(typeid(T), true)->operator_new = [](std::size_t) -> void* {
    const auto name = pybind11::type::of<T>().attr("__name__").template cast<std::string>();
    throw pybind11::type_error("this " + name + " was not made: its __init__ has not run");
  };
}

/// A member as Python keeps it in a pickle, and back.
template <class Member>
pybind11::object kept(const Member& member) {
  if constexpr (std::is_enum_v<Member>)
    return pybind11::int_(int(member));
  else if constexpr (std::is_base_of_v<pybind11::object, Member>)
    return member;
  else
    return pybind11::cast(member);
}
inline pybind11::object kept(const double (&x)[3]) { return pybind11::make_tuple(x[0], x[1], x[2]); }
template <class Member>
void take_back(pybind11::handle from, Member& member) {
  if constexpr (std::is_enum_v<Member>)
    member = Member(from.cast<int>());
  else
    member = from.cast<Member>();
}
inline void take_back(pybind11::handle from, double (&x)[3]) {
  for (std::size_t i = 0; i < 3; ++i) x[i] = from[pybind11::int_(i)].cast<double>();
}
/// Pickling of a value by its members.
template <class T, auto... members>
auto pickled() {
  return pybind11::pickle([](const T& it) { return pybind11::make_tuple(kept(it.*members)...); },
                          [](const pybind11::tuple& saved) {
                            T it;
                            std::size_t i = 0;
                            (take_back(saved[i++], it.*members), ...);
                            return it;
                          });
}

/// Makes the module's exceptions, and translates the library's errors to them.
void add_errors();
void add_scene(pybind11::module_& module);
void add_world(pybind11::module_& module);
void add_film(pybind11::module_& module);
/// Ends the movies that were not closed, without a file.
void give_up_movies();

/// Before Python ends: ends all long work of other threads, which then stay where they are, as there is no
/// Python to come back to. To be called with Python's lock.
void end_work();

/// Long work without Python's lock, which Ctrl-C ends. Ends with the exception of the signal's handler.
class __attribute__((visibility("hidden"))) Unlocked {
 public:
  Unlocked();
  ~Unlocked();

 private:
  PyThreadState* saved_;
};

/// act() without Python's lock.
template <class Act>
auto unlocked(Act&& act) {
  try {
    const Unlocked here;
    return act();
  } catch (const Interrupted&) {
    if (PyErr_Occurred()) throw pybind11::error_already_set();
    throw;
  }
}

}  // namespace obscura::python
