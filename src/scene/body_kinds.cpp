// The table of the kinds of body. The parser, the schema, the page of keys, the names of --set, the counts of
// `check` and the making of bodies all read it; pictures and exports follow from the form that it makes.

#include "scene/body_kinds.h"

#include <limits>
#include <type_traits>
#include <variant>

#include "scene/solid.h"

namespace obscura::scene {

namespace {

constexpr Range kAboveZero{0, std::numeric_limits<double>::infinity(), true};

// which of Forms<D> is F
template <class F, int D>
constexpr int form_number() {
  return []<class... All>(std::variant<All...>*) {
    int number = 0;
    (void)((std::is_same_v<F, All> ? true : (++number, false)) || ...);
    return number;
  }(static_cast<sim::Forms<D>*>(nullptr));
}

template <class F, int D>
constexpr Maker<D> makes(sim::Shape<D> (*make)(const Fields&, int, int, Diagnostics&)) {
  return {form_number<F, D>(), make};
}

template <int D>
constexpr Maker<D> kNeither{-1, nullptr};

template <int D>
sim::Shape<D> particle(const Fields& fields, int i, int n, Diagnostics&) {
  if (const Node* radius = fields.given("radius")) return sim::Ball<D>{number(*radius, i, n)};
  return sim::Point<D>{};
}

template <int D>
sim::Shape<D> ball(const Fields& fields, int i, int n, Diagnostics&) {
  return sim::Ball<D>{number(fields.node("radius"), i, n)};
}

template <int D>
sim::Shape<D> box(const Fields& fields, int, int, Diagnostics&) {
  return sim::Box<D>{fields.vector<D>("size") / 2};
}

sim::Shape<3> rod(const Fields& fields, int i, int n, Diagnostics& complaints) {
  return capsule(fields, number(fields.node("length"), i, n), number(fields.node("radius"), i, n),
                 complaints);
}

template <int D>
sim::Shape<D> of_points(const Fields& fields, int, int, Diagnostics& complaints) {
  const Node* points = fields.given("points");
  return points ? convex<D>(*points, complaints) : sim::Ball<D>{1};
}

template <int D>
sim::Shape<D> of_shapes(const Fields& fields, int, int, Diagnostics& complaints) {
  const Node* shapes = fields.given("shapes");
  return shapes ? compound<D>(*shapes, complaints) : sim::Ball<D>{1};
}

// clang-format off
constexpr BodyKind kKinds[] = {
    {.name = "particle", .called = "particle", .plural = "particles",
     .doc = "A point mass, or a ball if it has a `radius`. It does not turn: friction at its rim gives it no spin, so that angular momentum is lost there; a `[[ball]]` keeps it.",
     .dimension = 0, .instead = "", .turns = false, .handout = true, .own_origin = false, .varies = true,
     .measure = "radius", .stream = 0,
     .keys = [] { return std::vector<Key>{
         {.path = "particle.mass", .form = Form::number, .unit = "kg", .fallback = "1", .range = kAboveZero, .varies = true,
          .doc = "Its mass.", .example = "0.5"},
         {.path = "particle.radius", .form = Form::number, .unit = "m", .absent = "a point, drawn as a dot", .range = kAboveZero,
          .varies = true, .doc = "Its radius; its surface touches walls.", .example = "0.06"}}; },
     .plane = makes<sim::Point<2>, 2>(particle<2>), .space = makes<sim::Point<3>, 3>(particle<3>)},

    {.name = "ball", .called = "ball", .plural = "balls", .doc = "A disc, in space a ball, that turns and rolls.",
     .dimension = 0, .instead = "", .turns = true, .handout = false, .own_origin = false, .varies = true,
     .measure = "radius", .stream = 1ull << 40,
     .keys = [] { return std::vector<Key>{
         {.path = "ball.radius", .form = Form::number, .unit = "m", .fallback = "0.2", .range = kAboveZero, .varies = true,
          .doc = "Its radius.", .example = "0.1"}}; },
     .plane = makes<sim::Ball<2>, 2>(ball<2>), .space = makes<sim::Ball<3>, 3>(ball<3>)},

    {.name = "box", .called = "box", .plural = "boxes", .doc = "A rigid body with sides at right angles.",
     .dimension = 0, .instead = "", .turns = true, .handout = true, .own_origin = false, .varies = false,
     .measure = "size", .stream = 1,
     .keys = [] { return std::vector<Key>{
         {.path = "box.size", .form = Form::vector, .unit = "m", .fallback = "[0.8, 0.5]", .range = {0, 1e13, true}, .in_space = "[0.8, 0.5, 0.6]",
          .doc = "Width and height, in space width, height and depth, in its own frame.", .example = "[1.0, 0.5]"}}; },
     .plane = makes<sim::Box<2>, 2>(box<2>), .space = makes<sim::Box<3>, 3>(box<3>)},

    {.name = "capsule", .called = "capsule", .plural = "capsules", .doc = "A rod with round ends, along its own y. In space.",
     .dimension = 3, .instead = "a [[box]] and two balls make one of a [[body]]",
     .turns = true, .handout = false, .own_origin = false, .varies = true,
     .measure = "radius", .stream = 4ull << 40,
     .keys = [] { return std::vector<Key>{
         {.path = "capsule.length", .form = Form::number, .unit = "m", .fallback = "0.8", .range = kAboveZero, .varies = true,
          .doc = "Its length from end to end.", .example = "0.5"},
         {.path = "capsule.radius", .form = Form::number, .unit = "m", .fallback = "0.15", .range = kAboveZero, .varies = true,
          .doc = "Radius of the rod and its ends.", .example = "0.1"}}; },
     .plane = kNeither<2>, .space = makes<sim::Capsule, 3>(rod)},

    {.name = "polygon", .called = "polygon", .plural = "polygons",
     .doc = "A convex rigid body of any number of corners. In the plane.",
     .dimension = 2, .instead = "it is a [[hull]]", .turns = true, .handout = false, .own_origin = true, .varies = false,
     .measure = "points", .stream = 2ull << 40,
     .keys = [] { return std::vector<Key>{
         {.path = "polygon.points", .form = Form::points, .unit = "m", .required = true,
          .doc = "Its corners in its own frame, in order, clockwise or counter-clockwise.",
          .example = "[[0, 0], [0.3, 0], [0.2, 0.25]]"}}; },
     .plane = makes<sim::Polygon, 2>(of_points<2>), .space = kNeither<3>},

    {.name = "hull", .called = "hull", .plural = "hulls",
     .doc = "A rigid body: the convex hull of its points. In space.",
     .dimension = 3, .instead = "it is a [[polygon]]", .turns = true, .handout = false, .own_origin = true, .varies = false,
     .measure = "points", .stream = 5ull << 40,
     .keys = [] { return std::vector<Key>{
         {.path = "hull.points", .form = Form::points, .unit = "m", .dimension = 3, .required = true,
          .doc = "Points in its own frame. Points inside the hull of the others are ignored; triangles in one plane make one face.",
          .example = "[[0, 0, 0], [0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.3]]"}}; },
     .plane = kNeither<2>, .space = makes<sim::Hull, 3>(of_points<3>)},

    {.name = "body", .called = "body of several shapes", .plural = "bodies of several shapes",
     .doc = "A rigid body made of several shapes.",
     .dimension = 0, .instead = "", .turns = true, .handout = false, .own_origin = true, .varies = false,
     .measure = "shapes", .stream = 3ull << 40,
     .keys = [] { return std::vector<Key>{
         {.path = "body.shapes", .form = Form::tables, .required = true,
          .doc = "Its parts, in its own frame: each a ball, a box or a polygon, in space also a capsule or a hull. Where parts overlap, mass is counted twice."},
         {.path = "body.shapes.radius", .form = Form::number, .unit = "m", .absent = "no ball", .range = kAboveZero,
          .doc = "The part is a ball; with a `length`, a capsule.", .example = "0.1"},
         {.path = "body.shapes.length", .form = Form::number, .unit = "m", .absent = "no capsule", .range = kAboveZero, .dimension = 3,
          .doc = "The part is a capsule along its own y, of this length from end to end.", .example = "0.5"},
         {.path = "body.shapes.size", .form = Form::vector, .unit = "m", .absent = "no box", .range = {0, 1e13, true},
          .doc = "The part is a box.", .example = "[0.6, 0.1]"},
         {.path = "body.shapes.points", .form = Form::points, .unit = "m", .absent = "no polygon",
          .doc = "The part is a convex polygon, in space a hull.", .example = "[[0, 0], [0.3, 0], [0.2, 0.25]]"},
         {.path = "body.shapes.position", .form = Form::vector, .unit = "m", .fallback = "[0, 0]",
          .doc = "Position of the part's origin in the body's frame.", .example = "[0.2, 0]"},
         {.path = "body.shapes.angle", .form = Form::number, .unit = "deg", .fallback = "0", .dimension = 2, .instead = "it is 'orientation'",
          .doc = "Angle of the part in the body's frame. In the plane.", .example = "45"},
         {.path = "body.shapes.orientation", .form = Form::turn, .absent = "upright", .dimension = 3, .instead = "it is 'angle'",
          .doc = "Orientation of the part in the body's frame. In space.", .example = "[0, 0, 45]"}}; },
     .plane = makes<sim::Compound<2>, 2>(of_shapes<2>), .space = makes<sim::Compound<3>, 3>(of_shapes<3>)},
};
// clang-format on

// the first row that makes a form
template <int D>
constexpr const BodyKind* row_of(int form) {
  for (const BodyKind& kind : kKinds)
    if (kind.maker<D>().form == form) return &kind;
  return nullptr;
}

// a form that no row makes
template <int D>
constexpr bool rows_make_every_form() {
  for (int form = 0; form < int(std::variant_size_v<sim::Forms<D>>); ++form)
    if (!row_of<D>(form)) return false;
  return true;
}
static_assert(rows_make_every_form<2>() && rows_make_every_form<3>(), "a form without a kind of body");

}  // namespace

std::span<const BodyKind> body_kinds() { return kKinds; }

template <int D>
const BodyKind& kind_of(const sim::Body<D>& body) {
  const sim::Shape<D>* shape = &body.shape;
  if (sim::parts(*shape) == 1) shape = &sim::part(*shape, 0);
  if (!body.turns() && sim::round_radius(*shape)) return *row_of<D>(form_number<sim::Point<D>, D>());
  return *row_of<D>(int(shape->index()));
}

template const BodyKind& kind_of<2>(const sim::Body<2>&);
template const BodyKind& kind_of<3>(const sim::Body<3>&);

}  // namespace obscura::scene
