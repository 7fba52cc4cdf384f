#pragma once

/// \file
/// Obscura in a program: rooms of bodies, simulated and filmed without a window.
///
///     #include <obscura/obscura.h>
///
///     obscura::Scene scene = obscura::Scene::read("room.toml");
///     obscura::World world(scene);
///     obscura::Renderer renderer(scene);
///     obscura::Movie movie("room.mp4", renderer);
///     for (int n = 0; world.time() < scene.duration(); world.step_to(++n / renderer.fps()))
///       movie.add(renderer.draw(world));
///     movie.close();
///
/// This header is the library's interface. It needs the standard library alone. docs/library.md says what may
/// change from one version to the next.
///
/// Units are SI: metres, kilograms, seconds, newtons, radians. x goes to the right and y up, angles of the
/// plane grow counter-clockwise; in space z comes towards the viewer. Columns of numbers have a row a body,
/// with 2 numbers in the plane and 3 in space.
///
/// Everything that fails throws an Error of one of the kinds below. Objects of one kind may be used in
/// several threads at once, each object by one thread at a time: a World, Renderer or Movie that is at work
/// throws UsageError to another thread, and to a force that asks its own world. So does one that was moved
/// into another. After fork() a child may use scenes and worlds of its parent; a Renderer or Movie it makes
/// itself.

/// \example film.cpp
/// A film, frame by frame.

/// \example force.cpp
/// A force of a program.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace [[gnu::visibility("default")]] obscura {

/// The version of the library, as in "0.2.0".
std::string_view version() noexcept;

// --- What goes wrong

/// What all errors of the library are.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One thing wrong with a scene, and its place: a line and column of its text, or of a built scene the key.
struct Fault {
  std::string file;
  int line = 0, column = 0;  // from 1; 0: the scene as a whole
  std::string key;           // "ball[0].radius" of a built scene; else empty
  std::string message;       // with a hint where there is one

  /// "a.toml:12:8: mass must be positive, got -1"
  std::string text() const;
};

/// A scene that is wrong: all of its faults, in the order of its text.
struct SceneError : Error {
  explicit SceneError(std::vector<Fault> all);
  std::vector<Fault> faults;
};

/// A run that cannot go on, or a world that is not whole: which body, what of it, when, and the likely cause.
struct RunError : Error {
  using Error::Error;
  double time = 0;  // s
  std::string body, quantity, fault, likely;
};

/// A state, column, name or option that does not fit.
struct UsageError : Error {
  using Error::Error;
};

/// A picture or file that cannot be made or read: OpenGL, fonts, codecs, the disk.
struct FileError : Error {
  using Error::Error;
};

/// What was asked for was interrupted by a signal, or by the function of interrupt_by().
struct Interrupted : Error {
  using Error::Error;
};

/// From now on the long work of this thread asks `stop` now and then whether to end; none: it ends when it is
/// done. Runs, films and sweeps that are ended throw Interrupted.
void interrupt_by(std::function<bool()> stop);

// --- Scenes

struct Value;
/// Keys and their values, in their order.
using Table = std::vector<std::pair<std::string, Value>>;

/// A value of the scene language: a number, a truth, text, a list or a table.
struct Value {
  using List = std::vector<Value>;
  std::variant<std::int64_t, double, bool, std::string, List, Table> is;

  Value(int x) : is(std::int64_t(x)) {}
  Value(std::int64_t x) : is(x) {}
  Value(double x) : is(x) {}
  Value(bool x) : is(x) {}
  Value(const char* text) : is(std::string(text)) {}
  Value(const void*) = delete;  // other pointers are no truths
  Value(std::string text) : is(std::move(text)) {}
  Value(std::initializer_list<Value> list) : is(List(list)) {}
  Value(List list) : is(std::move(list)) {}
  Value(Table table) : is(std::move(table)) {}

  bool operator==(const Value&) const = default;
};

/// Builds a scene key by key. A key that the language does not have is refused at once; what its value may be
/// is checked by build(), for some of it follows from others.
///
///     Scene scene = Builder()
///                       .set("room.size", {4, 2.25})
///                       .add("ball", {{"name", "ball"}, {"radius", 0.2}, {"position", {1, 1}}})
///                       .build();
class Builder {
 public:
  Builder() = default;
  /// All keys of a scene at once, tables within tables.
  explicit Builder(Table keys);

  /// Sets a key: "duration", "room.size", "film.fps". Throws SceneError for one that there is not.
  Builder& set(std::string_view key, Value value);
  /// Adds one more of a kind, as [[ball]] does: "ball", "joint", "film.caption".
  Builder& add(std::string_view kind, Table keys);

  const Table& keys() const { return keys_; }
  /// The scene as TOML: what Scene::parse() reads as the same scene.
  std::string text() const;
  /// The scene, checked. `name` is its title in messages and the name of its films. Throws SceneError.
  class Scene build(const std::string& name = "scene") const;

 private:
  Table keys_;
};

/// Rows of numbers, one after another, that belong to what handed them out.
struct Columns {
  const double* first = nullptr;
  std::size_t rows = 0, columns = 0;

  std::span<const double> row(std::size_t i) const { return {first + i * columns, columns}; }
  double operator()(std::size_t i, std::size_t k) const { return first[i * columns + k]; }
  std::size_t size() const { return rows * columns; }
};

/// All bodies at an instant within a step, as a force is given them: a row a body.
struct Stage {
  double time = 0;     // s
  Columns positions;   // of the centres of mass, m
  Columns velocities;  // m/s
  Columns spins;       // rad/s: one number in the plane, three in space
  Columns
      orientations;  // the matrix that turns the body's axes into the room's, row after row: 4 or 9 numbers
};

/// What a force answers, all zero before: a row a body.
struct Push {
  double* forces = nullptr;   // N at the centre of mass: rows of 2 or 3
  double* torques = nullptr;  // N m about it: rows of 1 or 3, axes of the room
};

/// A force that a program computes: called in every stage of the integrator, so that the scheme keeps its
/// order. Its answer follows from the stage alone, for steps are tried and taken again. What it throws comes
/// out of the step, which then has not been taken.
using Force = std::function<void(const Stage& stage, const Push& push)>;

/// One body of a scene.
struct Body {
  std::string name;
  std::string kind;  // "point", "ball", "box", ... : its form
  double mass = 0;   // kg
  bool fixed = false, turns = false;
};

/// A scene, read and checked: what is in the room, what it looks like, how it is filmed. It does not change;
/// copies are cheap.
class Scene {
 public:
  /// The scene of a file ("-": standard input), with values over its keys as --set takes them:
  /// {"ball.elasticity=0.9"}. Throws SceneError with all that is wrong.
  static Scene read(const std::string& file, const std::vector<std::string>& sets = {});
  /// The same from TOML; `name` stands for the file in messages.
  static Scene parse(const std::string& text, const std::string& name = "scene.toml",
                     const std::vector<std::string>& sets = {});

  /// The same scene with one more value set: with("ball.elasticity", 0.9). Forces stay.
  Scene with(std::string_view key, const Value& value) const;
  /// The same scene with a force that acts on all bodies. Throws UsageError for a scene with bonds, and a
  /// name that is taken.
  Scene with_force(const std::string& name, Force force) const;

  const std::string& name() const;               ///< the file's stem
  const std::string& file() const;               ///< as given
  const std::string& text() const;               ///< TOML, without what was set over it
  const std::vector<std::string>& sets() const;  ///< what was
  double duration() const;                       ///< s
  int dimension() const;                         ///< 2 or 3
  const std::vector<Body>& bodies() const;       ///< in the order of all columns: those that turn come last
  std::vector<std::string> forces() const;       ///< names of those that programs compute
  std::vector<std::string> warnings() const;     ///< what is likely to go wrong: steps too long for springs
  /// Its keys and values, with what was set over them: what Builder() takes.
  Table keys() const;
  /// Equal for scenes that say the same, however they say it: of their keys and values, not of layout,
  /// comments and the order of keys.
  std::string hash() const;

  struct Inside;  // the library's own
  explicit Scene(std::shared_ptr<const Inside> inside) : inside_(std::move(inside)) {}
  Scene(const Scene&) = default;  // and so it moves: what is moved from is still a scene
  Scene& operator=(const Scene&) = default;
  const Inside& inside() const { return *inside_; }

 private:
  std::shared_ptr<const Inside> inside_;
};

/// The scene language's JSON Schema (draft 7), with every key, its type, range, default and example.
std::string schema();

// --- Worlds

/// Two that touch. A wall is known by its number: floor, left, right, ceiling, then the scene's own.
struct Contact {
  int body = -1, other = -1, wall = -1;   // other: a body, or -1 where `wall` is touched
  double point[3] = {}, normal[3] = {};   // m; unit, towards `body`
  double gap = 0;                         // m, negative: inside
  double force[3] = {}, impulse[3] = {};  // on `body`: N; N s of the impacts in the last step
  enum class Mode { bouncing, sliding, sticking } mode = Mode::sticking;
};

/// Two that touch, whichever of their features do.
struct Pair {
  int body = -1, other = -1, wall = -1;
  auto operator<=>(const Pair&) const = default;
};
struct ContactChanges {
  std::vector<Pair> began, ended;  // ascending
};

/// A condition of the scene ([[when]]) that has fired.
struct Event {
  double time = 0;              // s
  std::string name, what;       // "touches", "crosses", ...
  std::vector<std::string> of;  // names of bodies, walls, joints
  std::vector<std::string> marks;
  bool stop = false;  // it ended the run
};

/// What is conserved, J.
struct Energies {
  double kinetic = 0, gravity = 0, springs = 0, fields = 0;
  double work = 0;   // of forces without a potential since the start, beside the total
  double total = 0;  // of the first four
};

/// The whole state of a world as a value.
struct State {
  std::vector<std::uint64_t> words;
  bool operator==(const State&) const = default;
};

/// A scene that runs: its bodies at an instant of the physics clock, which goes by whole steps.
class World {
 public:
  /// `threads` share a step where there is enough to share; 0: one a core. No bit hangs on it. Throws
  /// UsageError for less than 0.
  explicit World(const Scene& scene, int threads = 1);
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  const Scene& scene() const;

  double time() const;         ///< s
  std::int64_t steps() const;  ///< done since the start
  double step_length() const;  ///< s

  /// Goes on by whole steps. Throws RunError where the run cannot go on, Interrupted, and what a force
  /// throws; the world then stands where the last whole step left it.
  void step(std::int64_t count = 1);
  /// Goes on to the whole step that is nearest to t (s), if that is later.
  void step_to(double t);

  /// The number of the body of a name. Throws UsageError, with the name that was probably meant.
  int body(std::string_view name) const;

  // Columns are views of the state itself: they follow the world, and are good for as long as it is there. They
  // are in the axes of the room, also where the scene has an observer.
  Columns positions() const;   ///< of centres of mass, m: a row a body
  Columns velocities() const;  ///< m/s: a row a body
  /// Of the bodies that turn, from first_turning() on: rad, not wrapped; in space quaternions x, y, z, w of
  /// their principal axes.
  Columns turns() const;
  Columns spins() const;  ///< rad/s, likewise; in space in the axes of the room
  int first_turning() const;

  // What is set holds from the next step on; what sleeps wakes. Throws UsageError for columns of another
  // size, numbers that are not finite, bodies that would be outside the room, links of chains and bodies with
  // bonds. Where positions and turns have to go together, it is the next step that throws RunError for a body
  // outside the room: either may be set first.
  void set_positions(std::span<const double> all);
  void set_velocities(std::span<const double> all);
  void set_turns(std::span<const double> all);
  void set_spins(std::span<const double> all);

  /// A number of the state by its name, as `obscura states` has it: "energy.total", "ball.position.x". Throws
  /// UsageError.
  double read(std::string_view quantity) const;
  std::vector<std::string> quantities() const;
  Energies energies() const;

  std::vector<Contact> contacts() const;
  /// Pairs that touch and did not at the last call, or the start; and pairs that did and do not. What touched
  /// and parted between two calls is in neither: ask at each step for every bounce.
  ContactChanges contact_changes();
  /// All that has fired since the start, in the order of time.
  std::vector<Event> events() const;

  State save() const;
  /// Goes back, or on, to a state that was saved of a world of the same scene: it goes on to the same bits. A
  /// state of a scene with other values (a mass, the gravity) goes on by this one's. Throws UsageError for a
  /// state of another make: of other bodies, joints or conditions, or of another physics.rate, by whose steps
  /// time is counted.
  void restore(const State& state);
  /// Equal exactly when states are: 32 hexadecimal digits, as `obscura states` prints them.
  std::string hash() const;

  struct Inside;
  Inside& inside() const;

 private:
  std::unique_ptr<Inside> inside_;
};

// --- Pictures and films

/// What a picture or film has other than its scene says; zeros and empty words leave the scene's.
struct FilmOptions {
  int width = 0, height = 0;           // pixels, even for movies
  std::string fps{};                   // "60", "30000/1001"
  std::string theme{};                 // "paper" or "screen"
  std::string camera{};                // one of several
  bool transparent = false;            // the ground left out
  std::optional<double> from{}, to{};  // s of the run
  std::optional<double> crf{};         // of the encoder: lower is better
  std::string preset{}, codec{};       // likewise
  int jobs = 0;                        // films and sweeps: threads; 0: one a core
};

/// A picture: RGBA8, sRGB, row 0 at the top, rows without gaps, alpha not multiplied in.
struct Frame {
  int width = 0, height = 0;
  std::span<const std::uint8_t> pixels;  // of the renderer: good until its next picture
  std::int64_t number = 0;               // in the film
  double time = 0;                       // s of the run
  std::string state;                     // hash of the state that it shows
};

/// Draws a scene, off screen: its film frame by frame, instants, or worlds as they stand. Each has an OpenGL
/// context of its own; several draw side by side.
class Renderer {
 public:
  /// Throws FileError where there is no OpenGL, UsageError for options that do not fit.
  explicit Renderer(const Scene& scene, const FilmOptions& options = {});
  Renderer(Renderer&&) noexcept;
  ~Renderer();

  int width() const;
  int height() const;
  double fps() const;
  std::string fps_text() const;  ///< exactly: "30000/1001"
  std::int64_t frames() const;   ///< of the film

  /// The next frame of the film, as `obscura render` draws it; none after the last. Throws RunError.
  std::optional<Frame> next();
  /// Begins the film again.
  void rewind();
  /// The picture at t seconds of a run of its own.
  Frame at(double t);
  /// A world of this scene as it stands, with the trails of its bodies since it was made.
  Frame draw(const World& world);
  /// Gives away the pixels of the last picture, which its Frame goes on to show: to keep one without a copy.
  /// Empty where there is none, or it has been given away. The next one is drawn into `memory`, as of a
  /// picture that is no longer needed, where that is large enough.
  std::vector<std::uint8_t> take(std::vector<std::uint8_t> memory = {});

 private:
  struct Inside;
  Inside& inside() const;
  std::unique_ptr<Inside> inside_;
};

/// Writes a PNG, under a temporary name first. Throws FileError.
void write_png(const std::string& path, const Frame& frame, bool transparent = false);
/// The same as bytes.
std::vector<std::uint8_t> png(const Frame& frame, bool transparent = false);

/// A movie file that takes frames, from wherever: mp4, mkv, mov, webm or gif, by the ending of its name. Its
/// bytes depend on the frames alone. It does not say how to make it again: `obscura verify` refuses it.
class Movie {
 public:
  /// Of the renderer's size and frame rate. Throws FileError where it cannot be made here.
  Movie(const std::string& path, const Renderer& renderer, const FilmOptions& options = {});
  /// Requires width, height and fps.
  Movie(const std::string& path, const FilmOptions& options);
  Movie(Movie&&) noexcept;
  /// A movie that was not closed leaves nothing.
  ~Movie();

  /// Throws UsageError for a frame of another size, FileError.
  void add(const Frame& frame);
  std::int64_t frames() const;
  /// Finishes the file and renames it into place.
  void close();

 private:
  struct Inside;
  Inside& inside() const;
  std::unique_ptr<Inside> inside_;
};

/// Films a scene as `obscura render` does, on all cores: a movie, a sequence "frames/{frame:04}.png",
/// pages.pdf, or page.html that plays in a browser. Throws RunError, UsageError, FileError, Interrupted.
void film(const Scene& scene, const std::string& out, const FilmOptions& options = {});
/// The picture at t (s), as `obscura render --at` writes it.
void still(const Scene& scene, double t, const std::string& out, const FilmOptions& options = {});
/// The page that plays the film, as one HTML text.
std::string film_page(const Scene& scene, const FilmOptions& options = {});

/// A figure for print, as `obscura figure` makes it: SVG. Its instants (s); none: those of the scene.
std::string figure_svg(const Scene& scene, const std::vector<double>& at = {},
                       const FilmOptions& options = {});

/// A sweep: runs that differ in the values of keys, and what was measured of each.
struct Sweep {
  std::vector<std::string> heads;              // keys, then measures, then "trouble"
  std::vector<std::vector<std::string>> rows;  // in the order of the values, the last key's changing fastest
};

/// Runs all combinations of the values of keys ("ball.elasticity=0:1:0.1", "seed=1:100") and measures each
/// ("energy.total@5", "ball.position.y@max"), as `obscura sweep` does. Throws UsageError, SceneError.
Sweep sweep(const Scene& scene, const std::vector<std::string>& vary, const std::vector<std::string>& measure,
            int jobs = 0);

}  // namespace obscura
