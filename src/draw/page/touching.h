#pragma once

#include <algorithm>
#include <cstddef>

#include "sim/model/snapshot.h"

namespace obscura::draw {

/// All contacts of one thing with another, as one.
struct Touching {
  sim::Snapshot::Contact first;         // the first of them: whose they are
  std::size_t begin = 0, end = 0;       // among the snapshot's
  sim::Vec3 sum = sim::Vec3::Zero();    // of what they give to the first's body, N or N s
  sim::Vec3 point = sim::Vec3::Zero();  // the middle of them, m: those that press harder count for more
  double pressed = 0;  // how much they press together, N or N s; not positive: `point` means nothing
};

/// Calls found(Touching) for each pair of things that touch at an instant, in the order of its contacts.
/// `push`: what a contact gives, its force or impulse; each counts as if it pressed by `least` at least.
template <class Push, class Found>
void each_touching(const sim::Snapshot& now, const Push& push, double least, Found&& found) {
  for (std::size_t i = 0; i < now.contacts.size();) {
    Touching all{now.contacts[i], i, i};
    for (; i < now.contacts.size(); ++i) {
      const sim::Snapshot::Contact& each = now.contacts[i];
      if (each.body != all.first.body || each.other != all.first.other || each.wall != all.first.wall) break;
      const sim::Vec3& given = push(each);
      const double weight = std::max(given.dot(each.normal), least);
      all.sum += given, all.point += weight * each.point, all.pressed += weight;
    }
    all.end = i;
    if (all.pressed > 0) all.point /= all.pressed;
    found(all);
  }
}

}  // namespace obscura::draw
