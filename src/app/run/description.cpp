// Sentences about a run. All numbers are the run's own: the state is read at
// every step, an impact is a contact that is new, or gets an impulse, while the
// two come together faster than what gravity gives in no time.

#include "app/run/description.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/run/compared.h"
#include "app/run/shown.h"
#include "app/run/telling.h"
#include "app/run/trouble.h"
#include "draw/page/measure.h"
#include "draw/picture/prose.h"
#include "scene/complaints.h"

namespace obscura::app {

using namespace telling;

namespace {

constexpr double kSameInstant = 1e-6;         // s of the film
constexpr std::int64_t kMostSteps = 100'000;  // read; of longer runs every second, third, ...
constexpr std::size_t kToldSingly = 6;        // bodies, impacts: told one by one
constexpr std::size_t kMostHappenings = 300;  // impacts that are listed
constexpr double kSoft = 0.02;                // of sqrt(g L): slower is no impact
constexpr double kSame = 1e-3;                // of the energy: it has not changed
constexpr double kTurnedOver = 0.5;           // cosine to the axis of the start: it points the other way,
constexpr double kTurnsAbout = 0.9;           // or is that axis
constexpr double kStillSpeed = 1e-3,
                 kStillSpin = 1e-2;  // of the room's height, 1/s; rad/s: slower is no motion

struct Impact {
  double time = 0, speed = 0;  // s, m/s: along the normal, before
  int body = -1, other = -1, wall = -1;
  double seen = 0;  // s, the end of its step: of the first state after it
};

/// Reads a run instant by instant.
class Account {
 public:
  Account(const scene::Scene& scene, const sim::SceneInfo& cast)
      : scene_(scene),
        cast_(cast),
        bodies_(cast.bodies.size()),
        rest_(cast.bodies.size()),
        still_(cast.bodies.size()) {
    const double g = cast.gravity.norm();
    soft_ = kSoft * std::sqrt((g > 0 ? g : 9.81) * std::max(cast.scale, 1e-9));
  }
  void read(const sim::Snapshot& now);
  /// What the run's conditions did.
  void heed(const std::vector<sim::RunEvent>& events);
  std::vector<std::string> sentences() const;
  std::vector<Happening> happenings() const;

 private:
  struct Extremes {
    double fastest = 0, when_fastest = 0, highest = -1e300, when_highest = 0;
    bool faster = false;  // since it became the fastest
  };
  using Pair = std::tuple<int, int, int>;
  using Told = std::vector<std::pair<double, std::string>>;  // s, sentences
  void follow_turns(const sim::Snapshot& now);
  void follow_hands(const sim::Snapshot& now);
  std::vector<std::string> beginning() const;
  Told causes() const;
  std::vector<std::string> events() const;
  std::vector<std::string> extremes() const;
  std::vector<std::string> ending() const;
  std::string when(double t) const { return time(t, sim::value(scene_.duration)); }
  std::string other(const Impact& each) const {
    return each.other >= 0 ? called(cast_, each.other) : wall(cast_, each.wall);
  }

  // a bead at a wire's end goes on without it, conditions let joints go, all else breaks
  std::string parting(int joint) const {
    const sim::SceneInfo::Joint& it = cast_.joints[std::size_t(joint)];
    const std::string name = scene::one_line(it.name);
    return it.kind == sim::JointKind::wire && it.a >= 0
               ? fmt::format("{} leaves {}", called(cast_, it.a), name)
               : fmt::format("joint {} {}", name, parted_.contains(joint) ? "is let go" : "breaks");
  }

  std::string side(int body) const { return body < 0 ? std::string("the room") : called(cast_, body); }
  // of two that an event holds together
  std::string joining(int joint) const {
    const sim::SceneInfo::Joint& it = cast_.joints[std::size_t(joint)];
    return fmt::format("{} and {} are joined", side(it.a), side(it.b));
  }
  std::string cracking(int bond) const {
    const sim::SceneInfo::Bond& it = cast_.bonds[std::size_t(bond)];
    return fmt::format("the bond of {} and {} breaks", side(it.a), side(it.b));
  }
  // what becomes of bodies, joints or bonds at instants: of few each, of many how many
  template <class Each>
  void tell(const std::vector<std::pair<double, int>>& all, const Each& each, const std::string& many,
            Told& told) const {
    if (all.size() <= kToldSingly) {
      for (const auto& [at, which] : all)
        told.emplace_back(at, fmt::format("At {} {}.", when(at), each(which)));
      return;
    }
    const auto [first, last] = std::minmax_element(all.begin(), all.end());
    told.emplace_back(first->first, last->first > first->first
                                        ? fmt::format("From {} to {} {} {}.", when(first->first),
                                                      when(last->first), all.size(), many)
                                        : fmt::format("At {} {} {}.", when(first->first), all.size(), many));
  }

  const scene::Scene& scene_;
  const sim::SceneInfo& cast_;
  double soft_ = 0;
  std::optional<sim::Snapshot> first_, last_;
  struct Bound {
    double energy, time;  // J, s
  };
  Bound least_{1e300, 0}, greatest_{-1e300, 0};  // of the energy
  double most_energy_ = 0;                       // J, of all its parts
  std::vector<Impact> impacts_;
  std::vector<Extremes> bodies_;
  std::vector<std::optional<double>> rest_;                         // since when
  std::vector<std::optional<double>> still_;                        // likewise, without motion that shows
  std::vector<std::pair<double, int>> broken_, made_;               // joints
  std::vector<std::pair<double, int>> cracked_;                     // bonds
  std::vector<std::pair<double, int>> freed_, held_still_;          // bodies
  std::set<int> parted_;                                            // of them those that conditions let go
  std::vector<std::pair<std::string, std::vector<double>>> marks_;  // by their names, in the order of time
  std::set<Pair> touching_;
  struct Grip {
    int body = -1;
    double begin = 0, end = 0;  // s
  };
  std::vector<Grip> grips_;  // of the mouse's springs, in the order of time
  std::vector<int> held_;    // mice: which of them it is in; -1: none
  // How a free body turns: what turns about its middle axis turns over now and then, and its spin stays.
  struct Turning {
    sim::Vec3 axis = sim::Vec3::Zero();  // of its spin at the start, in the body's frame; zero: none
    sim::Vec3 way = sim::Vec3::Zero();   // the same in the room
    bool over = false, free = true;      // free: it touches nothing, and nothing holds it
    std::vector<double> times{};         // s, when it has turned over
    std::size_t along = 0, seen = 0;     // instants at which it turns about that axis; all

    // what wobbles is not said to turn over
    bool told() const { return free && !times.empty() && 2 * along > seen; }
  };
  std::vector<Turning> turning_;
};

void Account::read(const sim::Snapshot& now) {
  std::set<Pair> touching;
  std::map<Pair, Impact> met;
  const double h = last_ ? now.time - last_->time : 0;
  for (const sim::Snapshot::Contact& each : now.contacts) {
    const Pair pair{each.body, each.other, each.wall};
    touching.insert(pair);
    if (!last_) continue;
    // how fast they came together: by the velocities before and what pushes them, at the time tau at which
    //   -u tau - a tau^2 / 2 + u' (h - tau) = the way of one past the other in the step
    const auto at = [&](const sim::Snapshot& instant, int body) -> sim::Vec3 {
      if (body < 0) return sim::Vec3::Zero();
      const sim::Snapshot::Body& it = instant.bodies[std::size_t(body)];
      return it.velocity + it.spin.cross(each.point - it.position);
    };
    const auto pushed = [&](int body) -> sim::Vec3 {
      if (body < 0 || cast_.bodies[std::size_t(body)].fixed) return sim::Vec3::Zero();
      const sim::Snapshot::Body& it = last_->bodies[std::size_t(body)];
      return last_->gravity.value_or(cast_.gravity) +
             (it.field + it.drag + it.blast) / sim::mass(cast_, *last_, body);
    };
    const auto way = [&](int body) -> sim::Vec3 {
      if (body < 0) return sim::Vec3::Zero();
      return now.bodies[std::size_t(body)].position - last_->bodies[std::size_t(body)].position +
             0.5 * h *
                 (last_->bodies[std::size_t(body)].spin + now.bodies[std::size_t(body)].spin)
                     .cross(each.point - now.bodies[std::size_t(body)].position);
    };
    const double begun = (at(*last_, each.other) - at(*last_, each.body)).dot(each.normal),
                 ended = (at(now, each.body) - at(now, each.other)).dot(each.normal),
                 a = (pushed(each.other) - pushed(each.body)).dot(each.normal),
                 gone = (way(each.body) - way(each.other)).dot(each.normal), u = begun + 0.5 * h * a;
    const double tau = u + ended > 0 ? std::clamp((ended * h - gone) / (u + ended), 0.0, h) : 0;
    const double speed = begun + a * tau;
    const bool struck = each.impulse.dot(each.normal) > 0 || !touching_.contains(pair);
    if (!struck || !(speed > soft_)) continue;
    Impact& impact = met[pair];
    if (speed > impact.speed) impact = {last_->time + tau, speed, each.body, each.other, each.wall, now.time};
  }
  for (const auto& [pair, impact] : met)
    if (!touching_.contains(pair) || impact.speed > 4 * soft_) impacts_.push_back(impact);
  touching_ = std::move(touching);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const sim::Snapshot::Body& it = now.bodies[i];
    Extremes& its = bodies_[i];
    // up to the top of the first hump that stands out
    const double speed = it.velocity.norm();
    its.faster = speed > (its.faster ? 1 : 1.001) * its.fastest;
    if (its.faster) its.fastest = speed, its.when_fastest = now.time;
    if (it.position.y() > its.highest) its.highest = it.position.y(), its.when_highest = now.time;
    // the solver finds rest only after a while, and a body at rest moves where the observer moves
    const bool still = it.velocity.norm() < kStillSpeed * cast_.scale && it.spin.norm() < kStillSpin;
    if (!still)
      still_[i].reset();
    else if (!still_[i])
      still_[i] = now.time;
    if (!it.at_rest || !still)
      rest_[i].reset();
    else if (!rest_[i])
      rest_[i] = still_[i];
  }
  follow_turns(now);
  follow_hands(now);
  for (std::size_t i = 0; last_ && i < now.joints.size(); ++i)
    if (now.joints[i].broken != last_->joints[i].broken)
      (now.joints[i].broken ? broken_ : made_).emplace_back(now.time, int(i));
  for (std::size_t i = 0; last_ && i < std::min(now.bonds.size(), last_->bonds.size()); ++i)
    if (now.bonds[i] < last_->bonds[i]) cracked_.emplace_back(now.time, int(i));
  if (!first_) first_ = now;
  last_ = now;
  const sim::Energies& e = now.energies;
  if (e.total() < least_.energy) least_ = {e.total(), now.time};
  if (e.total() > greatest_.energy) greatest_ = {e.total(), now.time};
  most_energy_ = std::max({most_energy_, std::abs(e.total()), e.kinetic, std::abs(e.potential())});
}

void Account::follow_turns(const sim::Snapshot& now) {
  if (cast_.dimension == 2) return;
  turning_.resize(bodies_.size());
  const auto hold = [&](int body) {
    if (body >= 0) turning_[std::size_t(body)].free = false;
  };
  for (const sim::Snapshot::Contact& each : now.contacts) hold(each.body), hold(each.other);
  for (const sim::SceneInfo::Joint& each : cast_.joints) hold(each.a), hold(each.b);
  for (const sim::SceneInfo::Spring& each : cast_.springs) hold(each.a), hold(each.b);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const sim::Snapshot::Body& it = now.bodies[i];
    Turning& its = turning_[i];
    if (!turns(it.spin)) continue;
    const sim::Vec3 way = it.spin.normalized(), axis = it.orientation.conjugate() * way;
    if (!last_) its.axis = axis, its.way = way;
    const double along = its.axis.dot(axis);
    ++its.seen, its.along += std::abs(along) > kTurnsAbout;
    if (!(std::abs(along) > kTurnedOver && its.way.dot(way) > kTurnedOver)) continue;
    if (its.over != (along < 0)) its.times.push_back(now.time);
    its.over = along < 0;
  }
}

void Account::follow_hands(const sim::Snapshot& now) {
  held_.resize(now.mice.size(), -1);
  for (std::size_t i = 0; i < now.mice.size(); ++i) {
    const sim::Snapshot::Mouse& it = now.mice[i];
    const int body = it.pressed ? it.body : -1;
    if (held_[i] >= 0 && grips_[std::size_t(held_[i])].body != body) held_[i] = -1;
    if (body < 0) continue;
    if (held_[i] < 0) held_[i] = int(grips_.size()), grips_.push_back({body, now.time, now.time});
    grips_[std::size_t(held_[i])].end = now.time;
  }
}

// what is done to bodies: hands that pull, explosions that begin, what is let go or held
Account::Told Account::causes() const {
  Told told;
  for (const Grip& each : grips_) {
    if (told.size() >= kToldSingly) break;
    told.emplace_back(each.begin, fmt::format("From {} to {} a hand's spring pulls {}.", when(each.begin),
                                              when(each.end), called(cast_, each.body)));
  }
  std::vector<std::pair<double, int>> freed = freed_;
  if (scene_.trajectory) return told;
  std::visit(
      [&](const auto& world) {
        for (const auto& each : world.model.explosions) {
          const double start = sim::value(each.start);
          if (start > last_->time || told.size() >= 2 * kToldSingly) continue;
          sim::Vec3 center = sim::Vec3::Zero();
          center.head(each.center.size()) = each.center;
          told.emplace_back(start,
                            fmt::format("At {} there is an explosion at {}, which lasts {}.", when(start),
                                        whereabouts(center, cast_), when(sim::value(each.duration))));
        }
        for (const auto& drive : world.model.drives)
          if (drive.release && sim::value(*drive.release) <= last_->time)
            freed.emplace_back(sim::value(*drive.release), drive.body);
      },
      scene_.world);
  tell(
      freed, [&](int body) { return called(cast_, body) + " is let go"; }, "bodies are let go", told);
  tell(
      held_still_, [&](int body) { return called(cast_, body) + " is held where it is"; },
      "bodies are held where they are", told);
  return told;
}

void Account::heed(const std::vector<sim::RunEvent>& events) {
  for (const sim::RunEvent& event : events) {
    for (const std::string& mark : event.marks) {
      auto of = std::find_if(marks_.begin(), marks_.end(), [&](const auto& it) { return it.first == mark; });
      if (of == marks_.end()) of = marks_.insert(of, {mark, {}});
      of->second.push_back(sim::value(event.time));
    }
    std::visit(
        [&](const auto& world) {
          using When = typename std::decay_t<decltype(world.model.whens)>::value_type;
          using Change = typename std::decay_t<decltype(world.model.changes)>::value_type;
          const double at = sim::value(event.time), step = 1 / sim::value(world.model.rate);
          // seen where the step ends
          const auto at_once = [&](std::vector<std::pair<double, int>>& all, int joint) {
            for (auto& [time, of] : all)
              if (of == joint && time > at && time - at < 1.001 * step) time = at;
          };
          for (const auto& action : world.model.whens[std::size_t(event.when)].actions) {
            if (action.what == When::Action::Do::part) parted_.insert(action.of.begin(), action.of.end());
            for (const int of : action.of) {
              if (action.what == When::Action::Do::part) at_once(broken_, of);
              if (action.what == When::Action::Do::let_go)
                freed_.emplace_back(at, world.model.drives[std::size_t(of)].body);
              if (action.what != When::Action::Do::change) continue;
              const Change& change = world.model.changes[std::size_t(of)];
              if (change.of == Change::Of::hold) held_still_.emplace_back(at, change.index);
              if (change.of == Change::Of::join) at_once(made_, change.index);
            }
          }
        },
        scene_.world);
  }
}

std::vector<std::string> Account::beginning() const {
  std::vector<std::string> all;
  if (!scene_.look.title.empty()) all.push_back(headline(scene_.look));
  const double g = cast_.gravity.norm();
  all.push_back(fmt::format("In {} there {} {}{}.", cast_.dimension == 2 ? "the plane" : "space",
                            moving(cast_).size() == 1 ? "is" : "are", listed(cast_),
                            g > 0          ? fmt::format("; gravity is {} m/s²", numeral(g))
                            : cast_.forces ? ", without the room's gravity but with forces of the scene"
                                           : "; there is no gravity"));
  for (std::string& sentence : shown_marks(scene_.film.marks, scene_.look, cast_))
    all.push_back(std::move(sentence));
  for (const draw::Chart& chart : scene_.film.charts) all.push_back(shown_plot(chart, cast_));
  const std::vector<int> bodies = moving(cast_);
  if (bodies.size() > kToldSingly) {
    std::size_t resting = 0, turning = 0;
    for (const int body : bodies) {
      const sim::Snapshot::Body& it = first_->bodies[std::size_t(body)];
      resting += stands(it.velocity, cast_), turning += turns(it.spin);
    }
    if (resting == bodies.size())
      all.emplace_back(turning == 0 ? "All start without velocity." : "All start in place; some turn.");
    return all;
  }
  for (const int body : bodies) {
    const sim::Snapshot::Body& it = first_->bodies[std::size_t(body)];
    all.push_back(
        capital(fmt::format("{} starts at {}, {}.", called(cast_, body), whereabouts(it.position, cast_),
                            !stands(it.velocity, cast_) ? motion(it.velocity, cast_)
                            : turns(it.spin) ? fmt::format("turning at {} rad/s", numeral(it.spin.norm()))
                                             : std::string("at rest"))));
  }
  return all;
}

std::vector<std::string> Account::events() const {
  Told told = causes();
  for (std::size_t i = 0; i < turning_.size(); ++i) {
    const Turning& its = turning_[i];
    if (!its.told() || told.size() >= 2 * kToldSingly) continue;
    told.emplace_back(
        its.times.front(),
        its.times.size() == 1
            ? capital(fmt::format("{} turns over at {}.", called(cast_, int(i)), when(its.times[0])))
            : capital(fmt::format("{} turns over {} times, first at {}, last at {}.", called(cast_, int(i)),
                                  its.times.size(), when(its.times.front()), when(its.times.back()))));
  }
  if (impacts_.size() <= kToldSingly) {
    for (const Impact& each : impacts_)
      told.emplace_back(each.time, fmt::format("At {} {} hits {} at {} m/s.", when(each.time),
                                               called(cast_, each.body), other(each), numeral(each.speed)));
  } else {
    std::map<Pair, std::vector<const Impact*>> pairs;
    for (const Impact& each : impacts_) pairs[{each.body, each.other, each.wall}].push_back(&each);
    if (pairs.size() <= kToldSingly) {
      for (const auto& [pair, all] : pairs) {
        const Impact& first = *all.front();
        const std::string subject = capital(called(cast_, first.body));
        if (all.size() == 1)
          told.emplace_back(first.time, fmt::format("{} hits {} at {}, at {} m/s.", subject, other(first),
                                                    when(first.time), numeral(first.speed)));
        else
          told.emplace_back(first.time, fmt::format("{} hits {} {} times: first at {}, at "
                                                    "{} m/s, last at {}, at {} m/s.",
                                                    subject, other(first), all.size(), when(first.time),
                                                    numeral(first.speed), when(all.back()->time),
                                                    numeral(all.back()->speed)));
      }
    } else {
      const auto hardest =
          std::max_element(impacts_.begin(), impacts_.end(),
                           [](const Impact& a, const Impact& b) { return a.speed < b.speed; });
      const Impact& first = impacts_.front();
      told.emplace_back(
          first.time, fmt::format("There are {} impacts: the first at {}, when {} hits {}, "
                                  "and the hardest at {}, when {} "
                                  "hits {} at {} m/s.",
                                  impacts_.size(), when(first.time), called(cast_, first.body), other(first),
                                  when(hardest->time), called(cast_, hardest->body), other(*hardest),
                                  numeral(hardest->speed)));
    }
  }
  tell(
      broken_, [&](int joint) { return parting(joint); },
      parted_.size() >= broken_.size() ? "joints are let go" : "joints break", told);
  tell(
      cracked_, [&](int bond) { return cracking(bond); }, "bonds break", told);
  tell(
      made_, [&](int joint) { return joining(joint); }, "pairs are joined", told);
  for (const auto& [name, times] : marks_)
    told.emplace_back(
        times.front(),
        times.size() == 1
            ? fmt::format("At {} is the mark \"{}\".", when(times.front()), scene::one_line(name))
            : fmt::format("The mark \"{}\" comes {} times, first at {}, last at {}.", scene::one_line(name),
                          times.size(), when(times.front()), when(times.back())));
  const auto says = [&](const std::optional<draw::Cue>& start, const std::string& words) {
    const double at = start ? start->time : 0;
    // what waits for a mark that does not come is not shown
    if (at <= last_->time)
      told.emplace_back(at, fmt::format("The film says at {}: \"{}\"", when(at), scene::one_line(words)));
  };
  for (const draw::Caption& caption : scene_.film.titles.captions)
    says(caption.shown.start, draw::in_letters(caption.text));
  // cards stand where the run stands still for them
  for (const draw::Card& card : scene_.film.titles.cards)
    for (const draw::Pace::Frozen& still : scene_.film.speed.frozen()) {
      const double at = sim::value(still.world);
      if (std::abs(sim::value(still.film) - card.begin) > kSameInstant || at > last_->time) continue;
      const std::string between = card.title.empty() || card.text.empty() ? "" : ": ";
      told.emplace_back(at, fmt::format("A card says at {}: \"{}\"", when(at),
                                        scene::one_line(draw::in_letters(card.title) + between +
                                                        draw::in_letters(card.text))));
      break;
    }
  // of labels those that come at an instant
  for (const draw::Marks::Label& label : scene_.film.marks.labels)
    if (label.shown.start && label.quantity.empty())
      says(label.shown.start, draw::formula_in_letters(label.text));
  std::stable_sort(told.begin(), told.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> all;
  for (auto& [at, sentence] : told) all.push_back(std::move(sentence));
  return all;
}

std::vector<std::string> Account::extremes() const {
  std::vector<std::string> all;
  const std::vector<int> bodies = moving(cast_);
  if (bodies.size() > kToldSingly) return all;
  for (const int body : bodies) {
    const Extremes& its = bodies_[std::size_t(body)];
    const sim::Snapshot::Body& start = first_->bodies[std::size_t(body)];
    const bool faster = its.fastest > 1.05 * start.velocity.norm() && its.fastest > soft_;
    const bool higher = its.highest > start.position.y() + 0.01 * cast_.scale;
    if (faster && higher)
      all.push_back(capital(fmt::format("{} is fastest at {}, with {} m/s, and highest at {}, at y = {} m.",
                                        called(cast_, body), when(its.when_fastest), numeral(its.fastest),
                                        when(its.when_highest), numeral(its.highest))));
    else if (faster)
      all.push_back(capital(fmt::format("{} is fastest at {}, with {} m/s.", called(cast_, body),
                                        when(its.when_fastest), numeral(its.fastest))));
    else if (higher)
      all.push_back(capital(fmt::format("{} is highest at {}, at y = {} m.", called(cast_, body),
                                        when(its.when_highest), numeral(its.highest))));
  }
  return all;
}

std::vector<std::string> Account::ending() const {
  std::vector<std::string> all;
  const std::vector<int> bodies = moving(cast_);
  std::size_t resting = 0;
  for (const int body : bodies) resting += rest_[std::size_t(body)].has_value();
  if (bodies.size() > kToldSingly) {
    all.push_back(fmt::format("At the end, at {}, {} of {} bodies are at rest.", when(last_->time),
                              resting == bodies.size() ? "all" : numeral(double(resting)), bodies.size()));
  } else {
    for (const int body : bodies) {
      const sim::Snapshot::Body& it = last_->bodies[std::size_t(body)];
      const auto& since = rest_[std::size_t(body)];
      if (since && *since > 0)
        all.push_back(capital(fmt::format("{} comes to rest at {}, at {}.", called(cast_, body), when(*since),
                                          whereabouts(it.position, cast_))));
      else if (since)
        all.push_back(capital(fmt::format("{} stays at rest.", called(cast_, body))));
      else
        all.push_back(fmt::format("At the end, at {}, {} is at {} and {}.", when(last_->time),
                                  called(cast_, body), whereabouts(it.position, cast_),
                                  moves(it.velocity, it.spin, cast_)));
    }
  }
  const double before = first_->energies.total(), after = last_->energies.total();
  const double same = kSame * most_energy_;
  if (!(same > 0)) return all;
  std::string between;
  if (const double over = greatest_.energy - std::max(before, after); over > same)
    between += fmt::format(", up to {} J at {}", numeral(greatest_.energy), when(greatest_.time));
  if (const double under = std::min(before, after) - least_.energy; under > same)
    between += fmt::format(", down to {} J at {}", numeral(least_.energy), when(least_.time));
  if (std::abs(after - before) > same)
    all.push_back(
        fmt::format("The energy goes from {} J to {} J{}.", numeral(before), numeral(after), between));
  else if (between.empty())
    all.push_back(fmt::format("The energy stays {} J.", numeral(before)));
  else
    all.push_back(fmt::format("The energy is {} J at the start and at the end{}.", numeral(before), between));
  return all;
}

std::vector<Happening> Account::happenings() const {
  std::vector<const Impact*> impacts;
  for (const Impact& each : impacts_) impacts.push_back(&each);
  if (impacts.size() > kMostHappenings) {
    std::nth_element(impacts.begin(), impacts.begin() + kMostHappenings, impacts.end(),
                     [](const Impact* a, const Impact* b) { return a->speed > b->speed; });
    impacts.resize(kMostHappenings);
  }
  std::vector<Happening> all;
  for (const Impact* each : impacts)
    all.push_back({each->time, each->seen,
                   fmt::format("{} hits {}, closing at {} m/s", called(cast_, each->body), other(*each),
                               numeral(each->speed))});
  for (const auto& [at, joint] : broken_) all.push_back({at, at, parting(joint)});
  for (const auto& [at, joint] : made_) all.push_back({at, at, joining(joint)});
  for (const auto& [at, bond] : cracked_) all.push_back({at, at, cracking(bond)});
  return all;
}

std::vector<std::string> Account::sentences() const {
  std::vector<std::string> all;
  if (!first_) return all;
  for (const auto& part : {beginning(), events(), extremes(), ending()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

void sort(std::vector<Happening>& events) {
  std::stable_sort(events.begin(), events.end(), [](const Happening& a, const Happening& b) {
    return std::pair(a.seen, a.time) < std::pair(b.seen, b.time);
  });
}

}  // namespace

Story story(const scene::Scene& scene) {
  if (std::vector<Ahead::Run> runs = compared(scene); !runs.empty()) {
    Story all;
    if (!scene.look.title.empty()) all.sentences.push_back(draw::in_letters(scene.look.title) + ".");
    all.sentences.push_back(fmt::format("The film shows {} runs {} each other.", runs.size(),
                                        scene.film.over ? "over" : "beside"));
    for (Ahead::Run& run : runs) {
      run.scene.look.title = run.look.name, run.scene.look.subtitle = "";
      Story its = story(run.scene);
      for (std::string& sentence : its.sentences) all.sentences.push_back(std::move(sentence));
      for (Happening& each : its.events)
        all.events.push_back({each.time, each.seen, run.look.name + ": " + std::move(each.text)});
    }
    sort(all.events);
    return all;
  }
  const auto run = scene.shown_run();
  run->heed(interrupted);
  Account account(scene, run->scene_info());
  std::optional<sim::Trouble> trouble;
  const auto read = [&](sim::Rational t) {
    auto outcome = run->at(t);
    if (std::holds_alternative<sim::Stopped>(outcome)) throw Interrupted();
    if (const auto* found = std::get_if<sim::Trouble>(&outcome)) {
      trouble = *found;
      return false;
    }
    account.read(std::get<sim::Snapshot>(outcome));
    if (const auto divergence = run->divergence(); divergence && divergence->ended)
      trouble = divergence->trouble;
    return !trouble.has_value();
  };
  if (scene.trajectory) {
    for (const double t : scene.trajectory->times)
      if (const auto exact = sim::from_double(t); exact && (scene.duration < *exact || !read(*exact))) break;
  } else {
    const std::int64_t steps = sim::floor(scene.duration * run->rate()), stride = steps / kMostSteps + 1;
    sim::Rational last{0, 1};
    for (std::int64_t k = 0; k <= steps && !trouble; k += stride) read(last = sim::rational(k) / run->rate());
    if (!trouble && last < scene.duration) read(scene.duration);
  }
  const std::vector<sim::RunEvent> events = sim::events_until(*run, scene.duration);
  account.heed(events);
  Story all{account.sentences(), account.happenings()};
  for (const sim::RunEvent& event : events)
    for (const std::string& mark : event.marks)
      all.events.push_back({sim::value(event.time), sim::value(event.time), scene::one_line(mark)});
  sort(all.events);
  if (trouble && !scene.show_divergence) all.trouble = trouble;
  if (trouble)
    all.sentences.push_back(fmt::format("At {} the run ends: the {} of {} {}.",
                                        time(trouble->time, sim::value(scene.duration)), trouble->quantity,
                                        scene::one_line(trouble->body), trouble->what));
  return all;
}

std::string picture_text(const scene::Scene& scene, const sim::SceneInfo& cast, const sim::Snapshot& now) {
  if (scene.look.title.empty()) return instant_text(cast, now);
  return headline(scene.look) + " " + instant_text(cast, now);
}

std::string instant_text(const sim::SceneInfo& cast, const sim::Snapshot& now) {
  std::string all;
  const auto add = [&](const std::string& sentence) { all += (all.empty() ? "" : " ") + sentence; };
  const std::vector<int> bodies = moving(cast);
  add(fmt::format("{} at {}.", capital(listed(cast)), time(now.time, now.time)));
  if (bodies.size() > kToldSingly) {
    std::size_t resting = 0;
    for (const int body : bodies) resting += now.bodies[std::size_t(body)].at_rest;
    if (resting > 0) add(fmt::format("{} of {} bodies are at rest.", resting, bodies.size()));
    return all;
  }
  for (const int body : bodies) {
    const sim::Snapshot::Body& it = now.bodies[std::size_t(body)];
    add(capital(fmt::format("{} is at {} and {}.", called(cast, body), whereabouts(it.position, cast),
                            moves(it.velocity, it.spin, cast))));
  }
  return all;
}

}  // namespace obscura::app
