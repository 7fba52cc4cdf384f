// Linear stability of the integrators, on x'' = -w^2 x - g x'.
//   roots  z = h (-g/2 +- sqrt(g^2/4 - w^2))
//   growth of a step  R(z) = 1 + z                                (Euler)
//                            1 + z + z^2/2                        (midpoint)
//                            1 + z + z^2/2 + z^3/6 + z^4/24       (Runge-Kutta)
//   semi-implicit     the eigenvalues of a matrix of trace 2 - h g - h^2 w^2 and determinant 1 - h g
// Without damping Runge-Kutta is stable for h w <= 2 sqrt 2, semi-implicit for h w <= 2; midpoint and Euler
// grow at any step.
// Source: Hairer and Wanner, Solving Ordinary Differential Equations II (1996), §IV.2.

#include "sim/motion/stability.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "sim/constraint/joints/joint.h"
#include "sim/force/spring.h"
#include "sim/math/rational.h"

namespace obscura::sim {

namespace {

struct Complex {
  double re = 0, im = 0;
};
Complex operator*(Complex a, Complex b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
double square(Complex a) { return a.re * a.re + a.im * a.im; }

// 1 + z (1 + z/2 (1 + z/3 (...))), `order` terms
Complex series(Complex z, int order) {
  Complex sum{1, 0};
  for (int i = order; i >= 1; --i) {
    const Complex term = z * sum;
    sum = {1 + term.re / i, term.im / i};
  }
  return sum;
}

// the roots of z^2 - trace z + det, larger square of their magnitude
double larger_root(double trace, double det) {
  const double half = 0.5 * trace, disc = half * half - det;
  if (disc < 0) return det;
  const double root = std::fabs(half) + std::sqrt(disc);
  return root * root;
}

// square of the factor by which a step grows
double growth(Integrator integrator, double w2, double g, double h) {
  if (integrator == Integrator::semi_implicit) return larger_root(2 - h * g - h * h * w2, 1 - h * g);
  const int order = integrator == Integrator::rk4 ? 4 : integrator == Integrator::midpoint ? 2 : 1;
  const double disc = 0.25 * g * g - w2;
  if (disc < 0) return square(series({-0.5 * g * h, std::sqrt(-disc) * h}, order));
  const double root = std::sqrt(disc);
  return std::max(square(series({(-0.5 * g - root) * h, 0}, order)),
                  square(series({(-0.5 * g + root) * h, 0}, order)));
}

bool grows(Integrator integrator, double w2, double g, double h) {
  const bool has_limit = integrator == Integrator::rk4 || integrator == Integrator::semi_implicit;
  return !(growth(integrator, w2, g, h) - 1 <= (has_limit ? 1e-9 : 2 * h));
}

template <int D>
double yielding(const Model<D>& model, const End<D>& end) {
  if (end.body < 0 || model.bodies[end.body].fixed) return 0;
  const Body<D>& body = model.bodies[end.body];
  double sum = 1 / body.mass;
  if (body.turns()) sum += end.local.squaredNorm() / body.inertia.minCoeff();
  return sum;
}

// The least that a joint's coordinate yields in any pose, 1/kg or 1/(kg m^2). About a pin, with the masses
// m = m_a m_b / (m_a + m_b) of both and arms r of their centres:
//   (A + B - 2 C) / (A B - C^2)     A = I_a + m r_a^2,  B likewise,  C = m r_a . r_b <= m |r_a| |r_b|, A, B
// of one that is held to the room 1 / A.
template <int D>
double yielding(const Model<D>& model, const Joint<D>& joint) {
  const auto moves = [&](const End<D>& end) { return end.body >= 0 && !model.bodies[end.body].fixed; };
  const auto light = [&](const End<D>& end) { return moves(end) ? 1 / model.bodies[end.body].mass : 0; };
  const double lights = light(joint.a) + light(joint.b);
  if (!equations<D>(joint.kind).angle || lights == 0) return lights;
  const auto about_pin = [&](const End<D>& end) {
    return model.bodies[end.body].inertia.maxCoeff() + end.local.squaredNorm() / lights;
  };
  const auto yields = [](double inertia) { return inertia > 0 ? 1 / inertia : 0; };
  if (!moves(joint.a) || !moves(joint.b)) return yields(about_pin(moves(joint.a) ? joint.a : joint.b));
  const double a = about_pin(joint.a), b = about_pin(joint.b);
  const double arms = std::sqrt(joint.a.local.squaredNorm() * joint.b.local.squaredNorm()) / lights;
  const double c = std::min({arms, a, b});
  return a * b > c * c ? (a + b - 2 * c) / (a * b - c * c) : yields(std::max(a, b));
}

std::string brief(double x) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, x, std::chars_format::general, 3).ptr;
  return {digits, end};
}

}  // namespace

template <int D>
std::string named(const Model<D>& model, int body) {
  const std::string& name = model.bodies[body].name;
  return name.empty() ? "body " + std::to_string(body) : name;
}

const char* spelled(Integrator integrator) {
  switch (integrator) {
    case Integrator::rk4:
      return "rk4";
    case Integrator::midpoint:
      return "midpoint";
    case Integrator::euler:
      return "explicit Euler";
    case Integrator::semi_implicit:
      return "semi-implicit Euler";
  }
  return "";
}

template <int D>
std::vector<Tightness> tightness(const Model<D>& model, const std::vector<Grip<D>>& grips) {
  std::vector<Tightness> all(model.bodies.size());
  std::vector<double> most(model.bodies.size(), -1);
  for (int body = 0; body < int(all.size()); ++body) {
    all[body].body = body;
    all[body].damping = (model.bodies[body].drag + model.bodies[body].ground_drag) / model.bodies[body].mass;
  }
  const auto add = [&](int body, const SpringLaw& s, double yields, bool hand, int index) {
    if (body < 0 || model.bodies[body].fixed) return;
    Tightness& sum = all[body];
    sum.stiffness += s.stiffness * yields, sum.damping += s.damping * yields, ++sum.ties;
    if (s.stiffness * yields > most[body]) {
      most[body] = s.stiffness * yields;
      sum.hand = hand, sum.strongest = index;
    }
  };
  for (int i = 0; i < int(model.springs.size()); ++i) {
    const Spring<D>& s = model.springs[i];
    if (s.a.body == s.b.body) continue;
    const double yields = yielding(model, s.a) + yielding(model, s.b);
    add(s.a.body, law(s), yields, false, i);
    add(s.b.body, law(s), yields, false, i);
  }
  for (int i = 0; i < int(grips.size()); ++i) {
    if (grips[i].body < 0) continue;
    add(grips[i].body, law(model.mice[i]), yielding(model, End<D>{grips[i].body, grips[i].local}), true, i);
  }
  return all;
}

bool grows(Integrator integrator, const Tightness& oscillator, double h) {
  return grows(integrator, oscillator.stiffness, oscillator.damping, h);
}

// by Runge-Kutta  v = h a (1 - z/2 + z^2/6 - z^3/24 - (h w)^2/6 + ...),  z = h g, by midpoint h a (1 - z/2)
double share_answered(Integrator integrator, const Tightness& oscillator, double h) {
  const double z = h * oscillator.damping;
  if (integrator == Integrator::midpoint) return z / 2;
  if (integrator != Integrator::rk4) return 0;
  return z / 2 * (1 - z / 3 * (1 - z / 4)) + h * h * oscillator.stiffness / 6;
}

double longest_step(Integrator integrator, const Tightness& oscillator, double h) {
  if (!grows(integrator, oscillator, h)) return h;
  double stands = 0, falls = h;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (stands + falls);
    (grows(integrator, oscillator, middle) ? falls : stands) = middle;
  }
  return stands;
}

template <int D>
std::string step_too_long_message(const Model<D>& model, const Tightness& oscillator) {
  const double h = 1 / value(model.rate);
  if (!grows(model.integrator, oscillator, h)) return {};
  const double limit = longest_step(model.integrator, oscillator, h);
  std::string text = "step " + sim::text(Rational{model.rate.den, model.rate.num}) + " s is longer than ";
  const bool undamped = oscillator.damping * oscillator.damping < 1e-4 * oscillator.stiffness;
  if (model.integrator == Integrator::rk4 && undamped) {
    text += "2.828 sqrt(m/k) = " + brief(limit) + " s";
  } else if (model.integrator == Integrator::semi_implicit && undamped) {
    text += "2 sqrt(m/k) = " + brief(limit) + " s";
  } else {
    text += brief(limit) + " s, what " + std::string(spelled(model.integrator)) + " stands";
  }
  const std::string strongest =
      (oscillator.hand ? "mouse[" : "spring[") + std::to_string(oscillator.strongest) + "]";
  if (oscillator.of_joint) {
    text += " of the spring of " + model.joints[std::size_t(oscillator.strongest)].name;
  } else if (oscillator.ties == 0) {
    text += " of the drag";
  } else if (oscillator.ties == 1) {
    text += " of " + strongest;
  } else {
    text += " of " + std::to_string(oscillator.ties) + " springs, the strongest " + strongest + ",";
  }
  text += " on " + named(model, oscillator.body) + ": ";
  const double rate = std::ceil(1 / limit);
  return text + (rate < 1e15 ? "raise physics.rate above " + std::to_string(std::int64_t(rate))
                             : "it is too stiff for any physics.rate");
}

template <int D>
Tightness tightest(const Model<D>& model, const std::vector<Grip<D>>& grips) {
  Tightness worst;
  const double h = 1 / value(model.rate);
  double shortest = h;
  for (const Tightness& here : tightness(model, grips)) {
    if (model.bodies[here.body].fixed) continue;
    const double limit = longest_step(model.integrator, here, h);
    if (limit < shortest) shortest = limit, worst = here;
  }
  return worst;
}

template <int D>
Tightness tightest_of_joints(const Model<D>& model, int body) {
  Tightness worst;
  const double h = 1 / value(model.rate);
  double shortest = h;
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint<D>& joint = model.joints[i];
    if (!joint.coil || !joint.any_body([&](int held) { return held == body; })) continue;
    const double yields = yielding(model, joint);
    Tightness its;
    its.body = body, its.ties = 1, its.of_joint = true, its.strongest = int(i);
    its.stiffness = joint.coil->stiffness * yields, its.damping = joint.coil->damping * yields;
    const double limit = longest_step(model.integrator, its, h);
    if (limit < shortest) shortest = limit, worst = its;
  }
  return worst;
}

namespace {

template <int D>
std::vector<Trouble> foreseen(const Model<D>& model) {
  const std::vector<Grip<D>> none(model.mice.size());
  const std::vector<Tightness> all = tightness(model, none);
  Tightness worst = tightest(model, none);
  const double h = 1 / value(model.rate);
  double shortest = worst.body >= 0 ? longest_step(model.integrator, worst, h) : h;

  // a hand may take any body
  for (int mouse = 0; mouse < int(model.mice.size()); ++mouse) {
    for (const Tightness& free : all) {
      const Body<D>& body = model.bodies[free.body];
      if (body.fixed) continue;
      Tightness held = free;
      const double yields = yielding(
          model, End<D>{free.body, of_form(body.shape, [](const auto& form) { return form.hold(); })});
      held.stiffness += model.mice[mouse].stiffness * yields,
          held.damping += model.mice[mouse].damping * yields;
      ++held.ties, held.hand = true, held.strongest = mouse;
      const double limit = longest_step(model.integrator, held, h);
      if (limit < shortest) shortest = limit, worst = held;
    }
  }
  if (worst.body < 0) return {};
  return {
      {0, named(model, worst.body), "energy", "will grow from nowhere", step_too_long_message(model, worst)}};
}

}  // namespace

std::vector<Trouble> stability_warnings(const Model<2>& model) { return foreseen(model); }
std::vector<Trouble> stability_warnings(const Model<3>& model) { return foreseen(model); }

template std::string named<2>(const Model<2>&, int);
template std::vector<Tightness> tightness<2>(const Model<2>&, const std::vector<Grip<2>>&);
template std::string step_too_long_message<2>(const Model<2>&, const Tightness&);
template Tightness tightest<2>(const Model<2>&, const std::vector<Grip<2>>&);
template std::string named<3>(const Model<3>&, int);
template std::vector<Tightness> tightness<3>(const Model<3>&, const std::vector<Grip<3>>&);
template std::string step_too_long_message<3>(const Model<3>&, const Tightness&);
template Tightness tightest<3>(const Model<3>&, const std::vector<Grip<3>>&);
template Tightness tightest_of_joints<2>(const Model<2>&, int);
template Tightness tightest_of_joints<3>(const Model<3>&, int);

}  // namespace obscura::sim
