#include "sim/collide/may_touch.h"

#include <algorithm>

namespace obscura::sim {

template <int D>
MayTouch<D>::MayTouch(const Model<D>& model) : jointed_(model.bodies.size()) {
  for (const Body<D>& body : model.bodies) {
    const bool point = is_point(body.shape);
    kind_.push_back(char((body.fixed ? kFixed : 0) | (point ? kPoint : 0) | (body.handout ? kHandout : 0)));
  }
  for (const Rail<D>& rail : model.rails) kind_[std::size_t(rail.body)] &= char(~kPoint);

  std::vector<int> names;
  for (const Body<D>& body : model.bodies) names.push_back(body.group);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  const auto number = [&](int name) {
    return std::size_t(std::lower_bound(names.begin(), names.end(), name) - names.begin());
  };
  groups_ = names.size();
  for (const Body<D>& body : model.bodies) group_.push_back(int(number(body.group)));
  ignored_.assign(groups_ * groups_, 0);
  for (const auto& [one, other] : model.ignore) {
    const std::size_t i = number(one), k = number(other);
    if (i == groups_ || k == groups_ || names[i] != one || names[k] != other) continue;
    ignored_[i * groups_ + k] = ignored_[k * groups_ + i] = 1;
  }

  for (const Joint<D>& joint : model.joints) {
    if (joint.touching || joint.later || joint.kind == JointKind::pulley) continue;
    const auto hold = [&](int a, int b) {
      if (a < 0 || b < 0 || a == b) return;
      held_.push_back(std::minmax(a, b));
      jointed_[a] = jointed_[b] = 1;
    };
    hold(joint.a.body, joint.b.body);
    // wheels that mesh overlap by their teeth
    if (joint.kind == JointKind::gear) hold(joint.a.body, joint.over[0].body);
  }
  std::sort(held_.begin(), held_.end());
}

template <int D>
bool MayTouch<D>::joined(int a, int b) const {
  return std::binary_search(held_.begin(), held_.end(), std::pair<int, int>(std::minmax(a, b)));
}

template class MayTouch<2>;
template class MayTouch<3>;

}  // namespace obscura::sim
