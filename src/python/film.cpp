// Renderers, movies, films, pages, figures and sweeps.

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "python/convert.h"

namespace obscura::python {

namespace py = pybind11;

namespace {

using Pixels = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;

// an option's value, or TypeError
template <class T>
T option(const std::string& name, const py::handle& value, const char* kind) {
  try {
    return value.cast<T>();
  } catch (const py::cast_error&) {
    throw py::type_error(name + " is " + kind + ", not " + shown(value));
  }
}

FilmOptions options(const py::kwargs& given) {
  FilmOptions made;
  for (const auto& [key, value] : given) {
    const std::string name = py::str(key);
    if (value.is_none()) continue;
    if (name == "size") {
      const auto size = option<std::pair<int, int>>(name, value, "(width, height) in pixels");
      made.width = size.first, made.height = size.second;
      if (made.width < 1 || made.height < 1)
        throw UsageError("a picture of " + std::string(py::repr(value)) + " pixels");
    } else if (name == "width") {
      made.width = option<int>(name, value, "a whole number of pixels");
    } else if (name == "height") {
      made.height = option<int>(name, value, "a whole number of pixels");
    } else if (name == "fps") {
      made.fps = py::str(value);
    } else if (name == "theme") {
      made.theme = option<std::string>(name, value, "'paper' or 'screen'");
    } else if (name == "camera") {
      made.camera = option<std::string>(name, value, "a camera's name");
    } else if (name == "transparent") {
      made.transparent = option<bool>(name, value, "True or False");
    } else if (name == "start") {
      made.from = option<double>(name, value, "a number of seconds");
    } else if (name == "end") {
      made.to = option<double>(name, value, "a number of seconds");
    } else if (name == "crf") {
      made.crf = option<double>(name, value, "a number");
    } else if (name == "preset") {
      made.preset = option<std::string>(name, value, "a word");
    } else if (name == "codec") {
      made.codec = option<std::string>(name, value, "a word");
    } else if (name == "jobs") {
      made.jobs = option<int>(name, value, "a whole number of threads");
    } else {
      throw py::type_error(
          "no option '" + name +
          "'; there are size, width, height, fps, theme, camera, transparent, start, end, crf, preset, "
          "codec and jobs");
    }
  }
  return made;
}

// what the system would cut at a zero is an error
std::string file_name(const py::object& path) {
  const auto name = py::module_::import("os").attr("fspath")(path).cast<std::string>();
  if (name.find('\0') != std::string::npos) throw py::value_error("a path has no zero in it");
  return name;
}

// A picture of its own: an array, and what it shows.
struct Picture {
  Pixels pixels;  // height x width x 4
  std::int64_t number = 0;
  double time = 0;
  std::string state;
  bool transparent = false;
};

Frame frame_of(const Pixels& pixels) {
  if (pixels.ndim() != 3 || pixels.shape(2) != 4)
    throw py::value_error("a frame is an array of height x width x 4 bytes: red, green, blue, alpha");
  return {int(pixels.shape(1)), int(pixels.shape(0)), {pixels.data(), std::size_t(pixels.size())}, 0, 0, ""};
}

// of three colours, or of four; floating-point numbers do not tell whether 1 or 255 is white
Pixels with_alpha(const py::handle& given) {
  const py::array all = py::array::ensure(given);
  if (!all || (all.dtype().kind() != 'u' && all.dtype().kind() != 'i'))
    throw py::type_error("a frame is a Frame, or an array of bytes (uint8), 0 to 255" +
                         (all ? ", not of " + std::string(py::str(all.dtype())) : ""));
  if (all.dtype().kind() != 'u' || all.dtype().itemsize() != 1) {
    const py::object least = all.attr("min")(), most = all.attr("max")();
    if (all.size() > 0 && (least.attr("__lt__")(0).cast<bool>() || most.attr("__gt__")(255).cast<bool>()))
      throw py::value_error("a frame is of bytes, 0 to 255, not of " + std::string(py::str(least)) + " to " +
                            std::string(py::str(most)));
  }
  Pixels pixels = Pixels::ensure(all);
  if (pixels.ndim() != 3 || pixels.shape(2) != 3) return pixels;
  Pixels whole({pixels.shape(0), pixels.shape(1), py::ssize_t(4)});
  for (py::ssize_t i = 0; i < pixels.size() / 3; ++i) {
    std::memcpy(whole.mutable_data() + 4 * i, pixels.data() + 3 * i, 3);
    whole.mutable_data()[4 * i + 3] = 255;
  }
  return whole;
}

// Memory of pictures that are gone, for the next ones: what is fresh from the system costs a sixth of a
// frame.
class Attic {
 public:
  using Memory = std::vector<std::uint8_t>;
  Memory out() {
    const std::lock_guard held(lock_);
    if (all_.empty()) return {};
    Memory last = std::move(all_.back());
    all_.pop_back();
    return last;
  }
  void in(Memory memory) {
    constexpr std::size_t kMost = 2;
    const std::lock_guard held(lock_);
    if (all_.size() < kMost) all_.push_back(std::move(memory));
  }

 private:
  std::mutex lock_;
  std::vector<Memory> all_;
};

// A renderer, and what its pictures have in common.
struct Drawing {
  Drawing(const Scene& scene, const FilmOptions& how)
      : renderer(unlocked([&] { return std::make_unique<Renderer>(scene, how); })),
        transparent(how.transparent) {}

  // its last picture, whose pixels the array takes over; they come back when the array is gone
  Picture kept(const Frame& frame) {
    struct Lent {
      Attic::Memory pixels;
      std::shared_ptr<Attic> of;
    };
    auto lent = std::make_unique<Lent>(Lent{renderer->take(attic->out()), attic});
    const std::uint8_t* first = lent->pixels.data();
    const py::capsule owner(lent.release(), [](void* it) {
      const std::unique_ptr<Lent> back(static_cast<Lent*>(it));
      back->of->in(std::move(back->pixels));
    });
    return {Pixels({frame.height, frame.width, 4}, first, owner), frame.number, frame.time, frame.state,
            transparent};
  }

  std::unique_ptr<Renderer> renderer;
  bool transparent;
  std::shared_ptr<Attic> attic = std::make_shared<Attic>();
};

// A movie; none after an exception has left it.
struct Recording {
  explicit Recording(std::unique_ptr<Movie> of) : movie(new std::unique_ptr<Movie>(std::move(of))) {
    std::erase_if(recordings(), [](const auto& it) { return it.expired(); });
    recordings().push_back(movie);
  }
  std::shared_ptr<std::unique_ptr<Movie>> movie;
  Movie& open() const {
    if (!*movie) throw UsageError("this movie was given up");
    return **movie;
  }
  // all that there are: what is open when Python ends leaves nothing behind
  static std::vector<std::weak_ptr<std::unique_ptr<Movie>>>& recordings() {
    static std::vector<std::weak_ptr<std::unique_ptr<Movie>>> all;
    return all;
  }
};

}  // namespace

void give_up_movies() {
  for (const auto& each : Recording::recordings())
    if (const auto movie = each.lock()) movie->reset();
}

void add_film(py::module_& module) {
  py::class_<Picture>(module, "Frame", "A picture: red, green, blue and alpha, row 0 at the top.")
      .def_readonly("array", &Picture::pixels, "height x width x 4, uint8.")
      .def_readonly("number", &Picture::number, "In the film.")
      .def_readonly("time", &Picture::time, "s of the run")
      .def_readonly("state", &Picture::state, "The hash of the state that it shows.")
      .def(
          "__array__",
          [](const Picture& it, const py::object& type, const py::object& copy) -> py::object {
            if (!type.is_none() && !type.equal(it.pixels.dtype())) {
              if (copy.is(py::bool_(false))) throw py::value_error("another type of numbers needs a copy");
              return it.pixels.attr("astype")(type);
            }
            return copy.is(py::bool_(true)) ? it.pixels.attr("copy")() : py::object(it.pixels);
          },
          py::arg("dtype") = py::none(), py::arg("copy") = py::none())
      .def(
          "save",
          [](const Picture& it, const py::object& path) {
            const std::string name = file_name(path);
            if (!name.ends_with(".png")) throw UsageError(name + ": a frame is a PNG, name.png");
            write_png(name, frame_of(it.pixels), it.transparent);
          },
          py::arg("path"), "As a PNG.")
      .def(pickled<Picture, &Picture::pixels, &Picture::number, &Picture::time, &Picture::state,
                   &Picture::transparent>())
      .def("_repr_png_", [](const Picture& it) {
        const auto bytes = png(frame_of(it.pixels), it.transparent);
        return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      });

  py::class_<Drawing>(module, "Renderer")
      .def(py::init([](const Scene& scene, const py::kwargs& how) { return Drawing(scene, options(how)); }))
      .def_property_readonly("width", [](const Drawing& it) { return it.renderer->width(); })
      .def_property_readonly("height", [](const Drawing& it) { return it.renderer->height(); })
      .def_property_readonly("fps", [](const Drawing& it) { return it.renderer->fps(); })
      .def("__len__", [](const Drawing& it) { return it.renderer->frames(); })
      .def("__iter__",
           [](py::object self) {
             self.cast<Drawing&>().renderer->rewind();
             return self;
           })
      .def("__next__",
           [](Drawing& it) {
             const auto frame = unlocked([&] { return it.renderer->next(); });
             if (!frame) throw py::stop_iteration();
             return it.kept(*frame);
           })
      .def(
          "at",
          [](Drawing& it, double t) {
            const Frame frame = unlocked([&] { return it.renderer->at(t); });
            return it.kept(frame);
          },
          py::arg("t"), "The picture at t seconds.")
      .def(
          "draw",
          [](Drawing& it, const World& world) {
            const Frame frame = unlocked([&] { return it.renderer->draw(world); });
            return it.kept(frame);
          },
          py::arg("world"), "The picture of a world as it stands.");

  py::class_<Recording>(module, "Movie")
      .def(py::init([](const std::string& path, const py::object& renderer, const py::kwargs& how) {
             if (renderer.is_none()) return Recording(std::make_unique<Movie>(path, options(how)));
             return Recording(
                 std::make_unique<Movie>(path, *renderer.cast<Drawing&>().renderer, options(how)));
           }),
           py::arg("path"), py::arg("renderer") = py::none())
      .def(
          "add",
          [](Recording& it, const py::object& frame) {
            const Pixels pixels =
                py::isinstance<Picture>(frame) ? frame.cast<const Picture&>().pixels : with_alpha(frame);
            const Frame view = frame_of(pixels);
            Movie& movie = it.open();
            unlocked([&] { movie.add(view); });
          },
          py::arg("frame"), "One more frame: a Frame, or an array of height x width x 3 or 4 bytes.")
      .def("__len__", [](Recording& it) { return it.open().frames(); })
      .def(
          "close",
          [](Recording& it) {
            Movie& movie = it.open();
            unlocked([&] { movie.close(); });
          },
          "Ends the movie: only then its file is there.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](Recording& it, const py::object& type, const py::object&, const py::object&) {
        if (!type.is_none()) return it.movie->reset();
        Movie& movie = it.open();
        unlocked([&] { movie.close(); });
      });

  refuse_unmade<Picture>(), refuse_unmade<Drawing>(), refuse_unmade<Recording>();

  module.def("render", [](const Scene& scene, const std::string& out, const py::kwargs& how) {
    const FilmOptions made = options(how);
    unlocked([&] { film(scene, out, made); });
  });
  module.def("still", [](const Scene& scene, double t, const std::string& out, const py::kwargs& how) {
    const FilmOptions made = options(how);
    unlocked([&] { still(scene, t, out, made); });
  });
  module.def("film_page", [](const Scene& scene, const py::kwargs& how) {
    const FilmOptions made = options(how);
    return unlocked([&] { return film_page(scene, made); });
  });
  module.def("figure_svg", [](const Scene& scene, const std::vector<double>& at, const py::kwargs& how) {
    const FilmOptions made = options(how);
    return unlocked([&] { return figure_svg(scene, at, made); });
  });
  module.def("sweep", [](const Scene& scene, const std::vector<std::string>& vary,
                         const std::vector<std::string>& measure, int jobs) {
    const Sweep made = unlocked([&] { return sweep(scene, vary, measure, jobs); });
    return py::make_tuple(made.heads, made.rows);
  });
}

}  // namespace obscura::python
