#include "scene/fields.h"

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

const Node& Fields::node(std::string_view key) const {
  const Node* it = given(key);
  return it ? *it : fallback(owner_.empty() ? std::string(key) : owner_ + '.' + std::string(key));
}

sim::Vec<2> Fields::vector(std::string_view key) const { return scene::vector(node(key)); }

sim::Rational Fields::rational(std::string_view key) const { return exact(node(key)); }

sim::Vec<2> vector(const Node& node) { return {node.list()[0].number(), node.list()[1].number()}; }

sim::Rational exact(const Node& node) {
  if (node.is_text()) return *sim::parse_rational(node.text());
  return node.is_integer() ? sim::rational(std::get<std::int64_t>(node.value))
                           : *sim::from_double(node.number());
}

double number(const Node& node, int i, int n) {
  if (node.is_number()) return node.number();
  if (node.is_list()) return node.list()[std::size_t(i)].number();
  const double t = along(i, n);
  return (1 - t) * node.find("from")->number() + t * node.find("to")->number();
}

sim::Vec<2> vector(const Node& node, int i, int n) {
  if (node.is_list()) return vector(node);
  const double t = along(i, n);
  return (1 - t) * vector(*node.find("from")) + t * vector(*node.find("to"));
}

}  // namespace obscura::scene
