#include "python/convert.h"

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

namespace obscura::python {

namespace py = pybind11;

namespace {

// how often a run asks whether a signal has come
constexpr std::chrono::milliseconds kAsk{50};
constexpr int kDeepest = 100;  // lists and tables within each other
// for work of other threads at the end of Python
constexpr std::chrono::milliseconds kLongestEnd{10000};

std::atomic<bool> ending = false;
std::atomic<int> working = 0;
std::thread::id ends;  // the thread that ends Python

// whether Python's end has overtaken this thread: it must not ask for the lock, as Python would unwind it
bool overtaken() { return ending && std::this_thread::get_id() != ends; }
[[noreturn]] void stay() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

// act(), with where it was in what it throws: "ball" and "[3].mass: ..." are "ball[3].mass: ..."
template <class Act>
void told_at(const std::string& where, Act&& act) {
  const auto at = [&](const std::exception& error) {
    const std::string what = error.what();
    if (what.starts_with("[")) return where + what;
    return where + (what.find(": ") == std::string::npos ? ": " : ".") + what;
  };
  try {
    act();
  } catch (const py::type_error& error) {
    throw py::type_error(at(error));
  } catch (const py::value_error& error) {
    throw py::value_error(at(error));
  }
}

}  // namespace

Value value(py::handle from, int depth) {
  if (depth > kDeepest) throw py::value_error("nested too deep");
  if (py::isinstance<py::bool_>(from)) return from.cast<bool>();
  try {
    if (py::isinstance<py::int_>(from)) return from.cast<std::int64_t>();
    if (py::isinstance<py::float_>(from)) return from.cast<double>();
    if (py::isinstance<py::str>(from)) return from.cast<std::string>();
  } catch (const py::cast_error&) {
    // an integer of more than 64 bits, or half of a pair of UTF-16
    throw py::value_error(py::isinstance<py::str>(from) ? "no text of Unicode"
                                                        : "a number that is too large");
  }
  // numbers and arrays of NumPy
  if (py::hasattr(from, "tolist")) return value(from.attr("tolist")(), depth + 1);
  if (py::hasattr(from, "__fspath__")) return py::str(from.attr("__fspath__")()).cast<std::string>();
  if (py::hasattr(from, "keys")) return table(from, depth + 1);
  if (py::isinstance<py::sequence>(from)) {
    Value::List list;
    for (const py::handle each : from)
      told_at("[" + std::to_string(list.size()) + "]", [&] { list.push_back(value(each, depth + 1)); });
    return list;
  }
  throw py::type_error("a scene has numbers, words, lists and tables, not " +
                       py::str(py::type::handle_of(from)).cast<std::string>());
}

Table table(py::handle from, int depth) {
  Table table;
  for (const py::handle key : from.attr("keys")()) {
    const std::string name = py::str(key).cast<std::string>();
    told_at(name, [&] { table.emplace_back(name, value(from[key], depth)); });
  }
  return table;
}

void end_work() {
  ends = std::this_thread::get_id(), ending = true;
  const py::gil_scoped_release released;
  const auto begun = std::chrono::steady_clock::now();
  while (working > 0 && std::chrono::steady_clock::now() - begun < kLongestEnd)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

py::object object(const Value& from) {
  struct Visitor {
    py::object operator()(std::int64_t x) const { return py::int_(x); }
    py::object operator()(double x) const { return py::float_(x); }
    py::object operator()(bool x) const { return py::bool_(x); }
    py::object operator()(const std::string& text) const { return py::str(text); }
    py::object operator()(const Value::List& list) const {
      py::list all;
      for (const Value& each : list) all.append(object(each));
      return all;
    }
    py::object operator()(const Table& table) const { return dict(table); }
  };
  return std::visit(Visitor{}, from.is);
}

py::dict dict(const Table& from) {
  py::dict all;
  for (const auto& [key, value] : from) all[py::str(key)] = object(value);
  return all;
}

std::string shape(const py::array& of) {
  std::string text;
  for (py::ssize_t i = 0; i < of.ndim(); ++i) text += (i ? " x " : "") + std::to_string(of.shape(i));
  return text;
}

std::string shown(py::handle value) {
  constexpr std::size_t kLongest = 100;
  // on one line
  const auto text = py::str(" ").attr("join")(py::repr(value).attr("split")()).cast<std::string>();
  if (text.size() <= kLongest) return text;
  // not within a letter of several bytes
  std::size_t end = kLongest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end) + "...";
}

Numbers numbers(py::handle from, const std::string& what) {
  const auto refuse = [&](const std::string& got) {
    throw py::type_error(what + ": no array of numbers: " + got);
  };
  // of None NumPy makes a number that is none
  if (from.is_none()) refuse(shown(from));
  const py::array all = py::array::ensure(from);
  if (!all) refuse(shown(from));
  const char kind = all.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u' && kind != 'b' && kind != 'O')
    refuse(kind == 'c' ? "they are complex" : shown(from));
  const Numbers made = Numbers::ensure(all);
  if (!made) refuse(shown(from));
  return made;
}

// Work counts from before the lock is let go until it is held again.
Unlocked::Unlocked() {
  ++working;
  saved_ = PyEval_SaveThread();
  if (overtaken()) --working, stay();
  interrupt_by([asked = std::chrono::steady_clock::now(), ended = false]() mutable {
    if (overtaken()) return true;
    const auto now = std::chrono::steady_clock::now();
    if (ended || now - asked < kAsk) return ended;
    asked = now;
    const py::gil_scoped_acquire locked;
    return ended = PyErr_CheckSignals() != 0;
  });
}

Unlocked::~Unlocked() {
  interrupt_by({});
  if (overtaken()) --working, stay();
  PyEval_RestoreThread(saved_);
  --working;
}

// The classes of exceptions are Python's (obscura/errors.py), so that they have attributes, and pickle.
void add_errors() {
  // never let go: destructors of statics run after Python's end, where no object can be
  static const py::handle errors = py::module_::import("obscura.errors").release();
  py::register_exception_translator([](std::exception_ptr thrown) {
    const auto raise = [](const char* name, const auto&... arguments) {
      const py::object error = errors.attr(name)(arguments...);
      PyErr_SetObject(py::type::handle_of(error).ptr(), error.ptr());
    };
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const SceneError& error) {
      py::list faults;
      for (const Fault& each : error.faults)
        faults.append(errors.attr("Fault")(each.file, each.line, each.column, each.key, each.message));
      raise("SceneError", faults);
    } catch (const RunError& error) {
      raise("RunError", error.std::runtime_error::what(), error.time, error.body, error.quantity, error.fault,
            error.likely);
    } catch (const UsageError& error) {
      raise("UsageError", error.what());
    } catch (const FileError& error) {
      raise("FileError", error.what());
    } catch (const Interrupted&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    } catch (const Error& error) {
      raise("Error", error.what());
    }
  });
}

}  // namespace obscura::python
