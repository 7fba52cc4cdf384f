#include "scene/readings.h"

#include <fmt/format.h>

#include <algorithm>

namespace obscura::scene {

namespace {

struct Quantity {
  std::string_view word;
  sim::Reading::Of of;
};
constexpr Quantity kQuantities[] = {
    {"x", sim::Reading::Of::x},
    {"y", sim::Reading::Of::y},
    {"z", sim::Reading::Of::z},
    {"vx", sim::Reading::Of::vx},
    {"vy", sim::Reading::Of::vy},
    {"vz", sim::Reading::Of::vz},
    {"speed", sim::Reading::Of::speed},
    {"angle", sim::Reading::Of::angle},
    {"spin", sim::Reading::Of::spin},
    // as states and --measure say it
    {"position.x", sim::Reading::Of::x},
    {"position.y", sim::Reading::Of::y},
    {"position.z", sim::Reading::Of::z},
    {"velocity.x", sim::Reading::Of::vx},
    {"velocity.y", sim::Reading::Of::vy},
    {"velocity.z", sim::Reading::Of::vz},
    {"contact", sim::Reading::Of::contact},
    {"normal_force", sim::Reading::Of::normal_force},
    {"friction", sim::Reading::Of::friction},
    {"spring_force", sim::Reading::Of::spring_force},
    {"joint_force", sim::Reading::Of::joint_force},
    {"force", sim::Reading::Of::force},
    {"torque", sim::Reading::Of::torque},
};

bool in_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

}  // namespace

template <int D>
bool Readings<D>::read(const Node& node, const char* key, const std::string& text) {
  names_.constants.read_by(text);
  const auto several = [&](const std::string& name, std::size_t count, const char* what) {
    names_.complaints.add(node.place, fmt::format("'{}': {} is {} {}; an expression reads one of them", key,
                                                  scene::in_quotes(name), count, what));
    return false;
  };
  // where they stand in the text
  for (std::size_t dot = text.find('.'); dot != std::string::npos; dot = text.find('.', dot + 1)) {
    std::size_t end = dot + 1;
    while (end < text.size() && (in_word(text[end]) || text[end] == '.')) ++end;
    const std::string quantity = text.substr(dot + 1, end - dot - 1);
    std::size_t begin = dot;
    if (begin > 0 && text[begin - 1] == ']')
      while (begin > 0 && text[begin - 1] != '[') --begin;
    if (begin != dot && begin > 0) --begin;
    while (begin > 0 && (in_word(text[begin - 1]) || text[begin - 1] == '-')) --begin;
    // a name may have dashes, and a minus may stand before it
    for (; begin < dot; ++begin) {
      const bool starts = begin == 0 || !in_word(text[begin - 1]);
      const std::string name = text.substr(begin, dot - begin);
      const std::vector<int> held =
          starts && !names_.is_body(name) ? names_.joints(name) : std::vector<int>();
      if (!starts || (!names_.is_body(name) && held.empty())) continue;
      const std::string word = text.substr(begin, end - begin);
      if (std::find(words_.begin(), words_.end(), word) != words_.end()) break;
      if (!held.empty()) {
        if (held.size() > 1) return several(name, held.size(), "joints");
        if (quantity != "force" && quantity != "torque") {
          refused_.push_back({word, -1, "is not what conditions read of a joint: force and torque"});
          break;
        }
        words_.push_back(word);
        all_.push_back({held[0], quantity == "force" ? sim::Reading::Of::force : sim::Reading::Of::torque});
        break;
      }
      const std::vector<int> found = names_.roster.bodies(name, node.place, names_.complaints);
      if (found.empty()) return false;
      if (found.size() > 1) return several(name, found.size(), "bodies");
      const std::string why = refusal(found[0], quantity);
      if (!why.empty()) {
        refused_.push_back({word, -1, why});
        break;
      }
      words_.push_back(word);
      const auto of = std::find_if(std::begin(kQuantities), std::end(kQuantities),
                                   [&](const Quantity& it) { return it.word == quantity; });
      all_.push_back({found[0], of->of});
      break;
    }
  }
  return true;
}

template <int D>
std::vector<std::string> Readings<D>::known() const {
  std::vector<std::string> names{"t"};
  for (const auto& [name, number] : names_.constants.numbers()) names.push_back(name);
  for (const Group& group : names_.roster.groups)
    for (const char* quantity : {"x", "y", "vx", "vy", "speed", "angle", "spin"})
      if (names.size() < 2000) names.push_back(group.name + "." + quantity);
  for (const std::string_view name : sim::expression_functions()) names.emplace_back(name);
  for (const std::string_view name : sim::expression_numbers()) names.emplace_back(name);
  return names;
}

// why a quantity of a body cannot be read; empty: it can
template <int D>
std::string Readings<D>::refusal(int body, const std::string& quantity) const {
  const auto found = std::find_if(std::begin(kQuantities), std::end(kQuantities),
                                  [&](const Quantity& it) { return it.word == quantity; });
  if (found == std::end(kQuantities))
    return D == 2 ? "is not what conditions read: x, y, vx, vy, speed, angle, spin, contact, "
                    "normal_force, friction, spring_force and joint_force"
                  : "is not what conditions read: x, y, z, vx, vy, vz, speed, spin, contact, "
                    "normal_force, friction, spring_force and joint_force";
  using enum sim::Reading::Of;
  if (found->of == force || found->of == torque)
    return "is of a joint, and this is a body; joint_force is what joints give it";
  if (D == 2 && (found->of == z || found->of == vz)) return "is of space, and this scene is in the plane";
  if (D == 3 && found->of == angle) return "is of the plane, and this scene is in space";
  if ((found->of == angle || found->of == spin) && !names_.model.bodies[std::size_t(body)].turns())
    return "is of a body that turns, and this does not";
  return "";
}

template class Readings<2>;
template class Readings<3>;

}  // namespace obscura::scene
