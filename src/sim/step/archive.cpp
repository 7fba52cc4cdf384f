#include "sim/step/archive.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>

#include "sim/multibody/chain.h"

namespace obscura::sim {

namespace {

constexpr std::int64_t kMostSteps = std::int64_t(1) << 53;  // times of more would not be doubles

// every field of what a state is made of, once, in the order in which it lies in a file
template <class Visit, int D>
void fields(Visit& visit, Grip<D>& it) {
  visit(it.body), visit(it.local);
}
template <class Visit, int D>
void fields(Visit& visit, Touch<D>& it) {
  visit(it.body), visit(it.wall), visit(it.point), visit(it.impulse);
}
template <class Visit, int D>
void fields(Visit& visit, BodySpin<D>& it) {
  visit(it.w), visit(it.residual);
}
template <class Visit>
void fields(Visit& visit, LimitMet& it) {
  visit(it.steps), visit(it.first), visit(it.last);
}
template <class Visit, int D>
void fields(Visit& visit, Blast<D>& it) {
  visit(it.on), visit(it.forces), visit(it.torques);
}
template <class Visit, int D>
void fields(Visit& visit, PartPose<D>& it) {
  visit(it.x), visit(it.turn);
}
template <class Visit>
void fields(Visit& visit, ChainState& it) {
  visit(it.q), visit(it.v);
}
template <class Visit>
void fields(Visit& visit, Happening& it) {
  visit(it.when), visit(it.which), visit(it.step), visit(it.fraction);
}
template <class Visit>
void fields(Visit& visit, Wound& it) {
  visit(it.a), visit(it.b), visit(it.drag), visit(it.off_a), visit(it.off_b), visit(it.with);
  visit(it.given);
}
template <class Visit>
void fields(Visit& visit, WheelLeft& it) {
  visit(it.joint), visit(it.wheel), visit(it.wrap);
}
template <class Visit, int D>
void fields(Visit& visit, Made<D>& it) {
  visit(it.place), visit(it.turn), visit(it.length);
}
template <class Visit>
void fields(Visit& visit, EventLog& it) {
  visit(it.on), visit(it.done), visit(it.happenings), visit(it.changes), visit(it.stopped);
}
template <class Visit, int D>
void fields(Visit& visit, Contact<D>& it) {
  visit(it.key.a), visit(it.key.b), visit(it.key.feature), visit(it.touching), visit(it.point);
  visit(it.normal), visit(it.gap), visit(it.force), visit(it.impulse), visit(it.before);
}
template <class Visit, int D>
void fields(Visit& visit, State<D>& it) {
  visit(it.step), visit(it.beyond), visit(it.x), visit(it.v), visit(it.turn), visit(it.spin);
  visit(it.grips), visit(it.touches), visit(it.ledger.displacement), visit(it.ledger.impacts);
  visit(it.limits_met.work), visit(it.limits_met.substeps), visit(it.limits_met.rough),
      visit(it.limits_met.wildest.step), visit(it.limits_met.wildest.error),
      visit(it.limits_met.wildest.pace), visit(it.limits_met.passages);
  visit(it.energy_budget.level), visit(it.energy_budget.amount), visit(it.energy_budget.work),
      visit(it.body_spin), visit(it.blasts), visit(it.chain_states);
  visit(it.intact), visit(it.part_poses), visit(it.bonded), visit(it.contacts), visit(it.frozen),
      visit(it.quiet);
  visit(it.broken), visit(it.joint_forces), visit(it.joint_torques), visit(it.work), visit(it.released);
  visit(it.events), visit(it.on_piece), visit(it.wound), visit(it.wheels_left);
  visit(it.made);
}

template <class T>
constexpr bool kInteger = std::is_integral_v<T> || std::is_enum_v<T>;

// the fields as words, one after the other; a list begins with its length
struct Writer {
  std::vector<std::uint64_t> words;

  template <class T>
  void operator()(T& it) {
    if constexpr (kInteger<T>) {
      words.push_back(std::uint64_t(std::int64_t(it)));
    } else if constexpr (std::is_same_v<T, double>) {
      words.push_back(std::bit_cast<std::uint64_t>(it));
    } else {
      fields(*this, it);
    }
  }
  template <int N>
  void operator()(Eigen::Matrix<double, N, 1>& it) {
    for (int i = 0; i < N; ++i) (*this)(it[i]);
  }
  template <class T>
  void operator()(std::vector<T>& all) {
    words.push_back(all.size());
    for (T& one : all) (*this)(one);
  }
};

// and back; `sound` tells whether there were as many as asked for
struct Reader {
  std::span<const std::uint64_t> words;
  bool sound = true;
  int states = 0;  // one within another; of what bonds make there is one, and it has none

  std::uint64_t next() {
    if (words.empty()) {
      sound = false;
      return 0;
    }
    const std::uint64_t word = words.front();
    words = words.subspan(1);
    return word;
  }
  template <class T>
  void operator()(T& it) {
    if constexpr (kInteger<T>) {
      const auto word = std::int64_t(next());
      it = T(word);
      sound = sound && std::int64_t(it) == word;
    } else if constexpr (std::is_same_v<T, double>) {
      it = std::bit_cast<double>(next());
    } else {
      fields(*this, it);
    }
  }
  template <int D>
  void operator()(State<D>& it) {
    sound = sound && ++states <= 2;
    if (sound) fields(*this, it);
  }
  template <int N>
  void operator()(Eigen::Matrix<double, N, 1>& it) {
    for (int i = 0; i < N; ++i) (*this)(it[i]);
  }
  template <class T>
  void operator()(std::vector<T>& all) {
    const std::uint64_t count = next();
    // each element of the list takes at least one word
    if (count > words.size()) sound = false;
    for (std::uint64_t i = 0; sound && i < count; ++i) (*this)(all.emplace_back());
  }
};

}  // namespace

template <int D>
std::vector<std::uint64_t> saved(const State<D>& state) {
  Writer writer;
  // a visitor that reads and one that writes share the list of fields
  writer(const_cast<State<D>&>(state));
  return std::move(writer.words);
}

template <int D>
std::optional<State<D>> loaded(std::span<const std::uint64_t> words) {
  Reader reader{words};
  State<D> state;
  reader(state);
  if (!reader.sound || !reader.words.empty()) return {};
  return state;
}

template <int D>
bool fits(const State<D>& state, const Model<D>& model) {
  const std::size_t bodies = model.bodies.size(), joints = model.joints.size();
  std::size_t turning = 0;
  for (const Body<D>& body : model.bodies) turning += body.turns();
  const auto sized = [](const auto& all, std::size_t n) { return all.empty() || all.size() == n; };
  const auto body = [&](int i) { return i >= 0 && std::size_t(i) < bodies; };
  const auto wall = [&](int i) { return i >= 0 && std::size_t(i) < model.walls.size(); };

  bool good =
      state.step >= 0 && state.step < kMostSteps && state.beyond == 0 && state.x.size() == bodies &&
      state.v.size() == bodies && state.turn.size() == turning && state.spin.size() == turning &&
      finite(state) && sized(state.body_spin, turning) && state.grips.size() == model.mice.size() &&
      state.blasts.size() == model.explosions.size() &&
      state.work.size() == std::size_t(model.books_work()) && state.released.size() == model.drives.size() &&
      state.chain_states.size() == model.chains.size() && state.intact.size() == model.bonds.size() &&
      state.bonded.size() == std::size_t(!model.bonds.empty()) &&
      state.part_poses.size() == (model.bonds.empty() ? 0 : bodies) && sized(state.frozen, bodies) &&
      state.quiet.size() == state.frozen.size() && sized(state.broken, joints) &&
      sized(state.on_piece, joints) && sized(state.wound, joints) &&
      state.joint_forces.size() == state.broken.size() && state.joint_torques.size() == state.broken.size();
  std::size_t things = 0;
  for (const When<D>& when : model.whens) things += std::size_t(when.things());
  const EventLog& events = state.events;
  good = good && events.on.size() == things && events.done.size() == model.whens.size();
  for (const Happening& it : events.happenings) {
    good = good && it.when >= 0 && std::size_t(it.when) < model.whens.size() && it.which >= 0 &&
           it.which < model.whens[std::size_t(it.when)].things() && it.step >= 0 && it.step <= state.step &&
           it.fraction >= 0 && it.fraction < 1;
  }
  for (const int change : events.changes)
    good = good && change >= 0 && std::size_t(change) < model.changes.size();
  for (const Grip<D>& grip : state.grips) good = good && (grip.body == -1 || body(grip.body));
  for (const Touch<D>& touch : state.touches) good = good && body(touch.body) && wall(touch.wall);
  for (const Blast<D>& blast : state.blasts)
    good = good && sized(blast.forces, bodies) && blast.torques.size() == blast.forces.size();
  for (std::size_t i = 0; good && i < state.chain_states.size(); ++i) {
    const Chain<D>& tree = *model.chains[i].tree;
    good = state.chain_states[i].q.size() == std::size_t(tree.positions()) &&
           state.chain_states[i].v.size() == std::size_t(tree.velocities());
  }
  for (std::size_t i = 0; i < state.on_piece.size() && good; ++i) {
    const auto& curve = model.joints[i].curve;
    good = state.on_piece[i] >= 0 && state.on_piece[i] <= (curve ? curve->size() : 0);
  }
  good = good && sized(state.made, joints);
  for (const Made<D>& it : state.made)
    good = good && it.place.allFinite() && it.turn.allFinite() && std::isfinite(it.length);
  for (std::size_t i = 0; i < state.wound.size() && good; ++i) {
    const Wound& it = state.wound[i];
    const std::size_t wheels = model.joints[i].around.size();
    good = std::isfinite(it.a) && std::isfinite(it.b) && std::isfinite(it.drag) && std::isfinite(it.given) &&
           it.off_a >= 0 && it.off_b >= 0 && std::size_t(it.off_a) + std::size_t(it.off_b) <= wheels;
    // all that are one are pieces of one rope, in a row, each of which ends on a wheel where the next begins
    if (it.with == 0) continue;
    const std::int64_t head = std::int64_t(i) + std::min(0, it.with),
                       last = std::int64_t(i) + std::max(0, it.with);
    good = good && model.joints[i].rope >= 0 && head >= 0 && last < std::int64_t(joints) &&
           state.wound[std::size_t(head)].with >= std::int64_t(i) - head;
    for (std::int64_t k = std::int64_t(i) + 1; good && k <= last; ++k) {
      const Joint<D>&before = model.joints[std::size_t(k - 1)], &piece = model.joints[std::size_t(k)];
      good = piece.rope == before.rope && before.on_b.offset != 0 && piece.on_a.offset != 0 &&
             state.wound[std::size_t(k)].with == std::int64_t(i) - k;
    }
  }
  for (const WheelLeft& it : state.wheels_left) {
    good = good && it.joint >= 0 && std::size_t(it.joint) < joints && it.wheel >= 0 && std::isfinite(it.wrap);
    if (good)
      good =
          std::size_t(it.wheel) < std::max<std::size_t>(1, model.joints[std::size_t(it.joint)].around.size());
  }
  for (const Contact<D>& contact : state.contacts) {
    good = good && body(contact.key.a) && (body(contact.key.b) || wall(-1 - contact.key.b)) &&
           contact.touching <= ContactMode::slide;
  }
  return good;
}

template std::vector<std::uint64_t> saved<2>(const State<2>&);
template std::vector<std::uint64_t> saved<3>(const State<3>&);
template std::optional<State<2>> loaded<2>(std::span<const std::uint64_t>);
template std::optional<State<3>> loaded<3>(std::span<const std::uint64_t>);
template bool fits<2>(const State<2>&, const Model<2>&);
template bool fits<3>(const State<3>&, const Model<3>&);

}  // namespace obscura::sim
