#include "scene/fields.h"

#include <numbers>

#include "sim/math/exponential.h"

namespace obscura::scene {

namespace {

const Node kNone{{}, Node::Table{}};

// how far the i-th of n is from the first to the last
double along(int i, int n) { return n > 1 ? double(i) / (n - 1) : 0; }

}  // namespace

Fields Fields::of(const Node& top, const std::string& owner) {
  const Node* table = top.find(owner);
  return {table ? *table : kNone, owner};
}

Place Fields::place(std::string_view key) const {
  const Node* it = given(key);
  return it ? it->place : table_->place;
}

const Node& Fields::node(std::string_view key, int dimension) const {
  const Node* it = given(key);
  if (it) return *it;
  return fallback(owner_.empty() ? std::string(key) : owner_ + '.' + std::string(key), dimension);
}

template <int D>
sim::Vec<D> Fields::vector(std::string_view key) const {
  return scene::vector<D>(node(key, D));
}

sim::Rational Fields::rational(std::string_view key) const { return exact(node(key)); }

template <int D>
sim::Vec<D> vector(const Node& node) {
  sim::Vec<D> v;
  for (int k = 0; k < D; ++k) v[k] = node.list()[std::size_t(k)].number();
  return v;
}

sim::Rational exact(const Node& node) {
  if (node.is_text()) return sim::parse_rational(node.text()).value();
  return node.is_integer() ? sim::rational(std::get<std::int64_t>(node.value))
                           : sim::from_double(node.number()).value();
}

double number(const Node& node, int i, int n) {
  if (node.is_number()) return node.number();
  if (node.is_list()) return node.list()[std::size_t(i)].number();
  const double t = along(i, n);
  return (1 - t) * node.find("from")->number() + t * node.find("to")->number();
}

template <int D>
sim::Vec<D> vector(const Node& node, int i, int n) {
  if (node.is_list())
    return node.list().front().is_list() ? vector<D>(node.list()[std::size_t(i)]) : vector<D>(node);
  const double t = along(i, n);
  return (1 - t) * vector<D>(*node.find("from")) + t * vector<D>(*node.find("to"));
}

template <>
sim::AngularVec<2> spin<2>(const Node& node, int i, int n) {
  return sim::AngularVec<2>(radians(number(node, i, n)));
}

template <>
sim::AngularVec<3> spin<3>(const Node& node, int i, int n) {
  return vector<3>(node, i, n) * (std::numbers::pi / 180);
}

template <>
sim::Orientation<2> turn<2>(const Fields& fields, int i, int n) {
  return sim::Orientation<2>(radians(number(fields.node("angle"), i, n)));
}

template <>
sim::Orientation<3> turn<3>(const Fields& fields, int, int) {
  const Node* it = fields.given("orientation");
  if (!it) return sim::no_rotation<3>();
  if (it->is_table()) {
    const sim::Vec<3> axis = vector<3>(*it->find("axis")).stableNormalized();
    return sim::exponential(radians(it->find("angle")->number()) * axis);
  }
  // about x, then y, then z of the room
  sim::Orientation<3> all = sim::no_rotation<3>();
  for (int k = 0; k < 3; ++k)
    all = sim::product(sim::exponential(radians(it->list()[std::size_t(k)].number()) * sim::Vec<3>::Unit(k)),
                       all);
  return all;
}

double radians(double degrees) { return degrees * (std::numbers::pi / 180); }

double degrees(double radians) { return radians * (180 / std::numbers::pi); }

template sim::Vec<2> Fields::vector<2>(std::string_view) const;
template sim::Vec<3> Fields::vector<3>(std::string_view) const;
template sim::Vec<2> vector<2>(const Node&);
template sim::Vec<3> vector<3>(const Node&);
template sim::Vec<2> vector<2>(const Node&, int, int);
template sim::Vec<3> vector<3>(const Node&, int, int);

}  // namespace obscura::scene
