// A form answers all that is asked of forms, or does not compile; and a Shape stays small.

#include <gtest/gtest.h>

#include <numbers>

#include "sim/dice.h"
#include "sim/shape/form_concept.h"
#include "sim/shapes.h"
#include "sim/solids.h"

namespace obscura::sim {
namespace {

static_assert(all_forms_answer<2>() && all_forms_answer<3>());

// forms that each leave something out, by hiding what a ball answers
struct WithoutSpread : Ball<2> {
  void spread() const = delete;
};
struct WithoutVertices : Ball<2> {
  void add_support_vertices() const = delete;
};
struct WithoutThickness : Ball<2> {
  void half_thickness() const = delete;
};
struct WithoutReach : Ball<2> {
  void bounding_radius() const = delete;
};
struct WithoutBounds : Ball<2> {
  void bounds() const = delete;
};
struct WithoutOutside : Ball<2> {
  void outside() const = delete;
};
struct WithoutMoved : Ball<2> {
  void moved() const = delete;
};
struct WithoutSide : Ball<2> {
  void side() const = delete;
};
struct WithoutHold : Ball<2> {
  void hold() const = delete;
};
struct WithoutDrawn : Ball<2> {
  void drawn() const = delete;
};
struct WithoutCore : Ball<2> {
  void core() const = delete;
};
struct Complete : Ball<2> {};

static_assert(ConvexFormInterface<Complete, 2>);
static_assert(!FormInterface<WithoutSpread, 2> && !FormInterface<WithoutVertices, 2>);
static_assert(!FormInterface<WithoutThickness, 2> && !FormInterface<WithoutReach, 2>);
static_assert(!FormInterface<WithoutBounds, 2> && !FormInterface<WithoutOutside, 2>);
static_assert(!FormInterface<WithoutMoved, 2> && !FormInterface<WithoutSide, 2>);
static_assert(!FormInterface<WithoutHold, 2> && !FormInterface<WithoutDrawn, 2>);
static_assert(FormInterface<WithoutCore, 2> && !ConvexFormInterface<WithoutCore, 2>);
static_assert(!ConvexFormInterface<Ball<3>, 2>, "of the other dimension");

// as one struct with the fields of all kinds it had 128 and 168 bytes
static_assert(sizeof(Shape<2>) <= 64 && sizeof(Shape<3>) <= 96);

// what each answers hangs together: every support vertex is within the bounds, the reach and the form itself
template <int D>
void hangs_together(const Shape<D>& shape, const BodyMotion<D>& at) {
  const Bounds<D> around = bounds(shape, at);
  const double reach = bounding_radius(shape);
  Vec<D> lower = Vec<D>::Constant(1e9), upper = -lower;
  double far = 0;
  for (const SupportVertex<D>& tip : support_vertices(shape)) {
    const Vec<D> place = at.x + at.arm(tip.at), r = Vec<D>::Constant(tip.radius);
    lower = lower.cwiseMin(place - r), upper = upper.cwiseMax(place + r);
    far = std::max(far, tip.at.norm() + tip.radius);
    const double outside = of_form(shape, [&](const auto& form) { return form.outside(tip.at); });
    EXPECT_LE(outside, -tip.radius + 1e-14);
  }
  EXPECT_LE((around.lower - lower).norm() + (around.upper - upper).norm(), 1e-13);
  EXPECT_NEAR(reach, far, 1e-14);
  EXPECT_LE(half_thickness(shape), far + 1e-14);
}

TEST(Forms, AnswerOfThemselvesWhatHangsTogether) {
  SpaceDice dice(11);
  for (int n = 0; n < 300; ++n) {
    hangs_together<2>(dice.simple(1), dice.body_motion(3));
    hangs_together<3>(dice.solid(1), dice.place(3));
  }
}

// seen from another frame: the same content, the centroid carried along, the same distance of every place
TEST(Forms, StayWhatTheyAreInAnotherFrame) {
  SpaceDice dice(12);
  for (int n = 0; n < 200; ++n) {
    const Shape<3> shape = dice.solid(1);
    if (is_point(shape)) continue;
    const Orientation<3> turn = exponential(dice.vec(2));
    const Vec<3> by = dice.vec(1), at = dice.vec(2);
    const Placing<3> placing = [&](const Vec<3>& place) { return Vec<3>(by + rotation<3>(turn) * place); };
    const Shape<3> other = moved<3>(shape, placing, turn);
    const MassProperties<3> one = mass_properties(shape), two = mass_properties(other);
    EXPECT_EQ(shape.index(), other.index());
    EXPECT_NEAR(two.content, one.content, 1e-13);
    EXPECT_LE((two.center - placing(one.center)).norm(), 1e-13);
    EXPECT_NEAR(two.second.sum(), one.second.sum(), 1e-12);
    const auto outside = [](const Shape<3>& of, const Vec<3>& place) {
      return of_form(of, [&](const auto& form) { return form.outside(place); });
    };
    EXPECT_NEAR(outside(other, placing(at)), outside(shape, at), 1e-12);
  }
}

TEST(Forms, ABoxOfThePlaneThatTurnsIsAPolygon) {
  const Shape<2> box = Box<2>{{0.5, 0.2}, {1, 0}};
  const auto turned = [&](double angle) {
    const Orientation<2> by(angle);
    return moved<2>(
        box, [&](const Vec<2>& p) { return Vec<2>(rotation<2>(by) * p); }, by);
  };
  EXPECT_TRUE(form<Box<2>>(turned(0)));
  ASSERT_TRUE(form<Polygon>(turned(std::numbers::pi / 2)));
  EXPECT_NEAR((form<Polygon>(turned(std::numbers::pi / 2))->vertices[0] - Vec<2>(0.2, 0.5)).norm(), 0, 1e-15);
}

}  // namespace
}  // namespace obscura::sim
