// The extension module of the package `obscura`: its classes and functions, which obscura/__init__.py makes
// friendlier.

#include "python/convert.h"

PYBIND11_MODULE(_obscura, module) {
  using namespace obscura::python;
  module.attr("__version__") = std::string(obscura::version());
  add_errors();
  add_scene(module);
  add_world(module);
  add_film(module);
  // before Python ends nothing of it may be at work
  pybind11::module_::import("atexit").attr("register")(pybind11::cpp_function([] {
    end_work();
    give_up_movies();
  }));
}
