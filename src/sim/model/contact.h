#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <span>

#include "sim/math/vec.h"

namespace obscura::sim {

/// Which touch this is: it stays the same while the same features touch.
struct ContactKey {
  int a = -1, b = -1;  // bodies, a < b where both are; b = -1 - wall for a wall
  int feature = 0;     // which corner and face, see sim/collide/narrow_phase.h

  auto operator<=>(const ContactKey&) const = default;
};

/// The mode of a contact at an instant.
enum class ContactMode : std::uint8_t {
  open,
  stick,
  at_friction_limit,  // holds with all the friction there is
  slide
};

/// A contact as the state keeps it. Forces, not impulses: a partial step then starts rightly from them.
template <int D>
struct Contact {
  ContactKey key;
  ContactMode touching = ContactMode::open;
  Vec<D> point = Vec<D>::Zero();    // world frame, m
  Vec<D> normal = Vec<D>::Zero();   // unit, from b to a
  double gap = 0;                   // m, negative: inside
  Vec<D> force = Vec<D>::Zero();    // on a, N
  Vec<D> impulse = Vec<D>::Zero();  // on a, N s, of the impacts in the last step
  Vec<D> before = Vec<D>::Zero();   // the force in the step before, where a solver asks for it, N

  bool operator==(const Contact&) const = default;
};

/// That of a key among contacts in the order of their keys; null: there is none.
template <int D>
const Contact<D>* find_contact(std::span<const Contact<D>> contacts, const ContactKey& key) {
  const auto at =
      std::lower_bound(contacts.begin(), contacts.end(), key,
                       [](const Contact<D>& contact, const ContactKey& of) { return contact.key < of; });
  return at != contacts.end() && at->key == key ? &*at : nullptr;
}

}  // namespace obscura::sim
