// The wide passes of a substep over all batches, colour by colour. Those of a colour share no body that
// moves, so that threads share them, with the same bits.

#include <algorithm>
#include <atomic>
#include <numeric>

#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/plane.h"

namespace obscura::sim {

using plane::kLanes;

// act(begin, end, number) for all batches; the numbers of pieces, of so many batches, ascend as these do
template <class Act>
void PlaneIterative::by_colour(const Act& act, int piece) {
  if (!workers()) return act(0, int(batches_.size()), 0);
  const int colours = int(begin_.size()) - 1;
  for (int colour = 0; colour < colours; ++colour) {
    const int first = begin_[std::size_t(colour)] / kLanes, last = begin_[std::size_t(colour) + 1] / kLanes;
    const auto number = [&](int at) { return (first + at) / piece + colour; };
    if (colour + 1 < colours) {
      each(workers(), last - first, piece,
           [&](int begin, int end) { act(first + begin, first + end, number(begin)); });
    } else if (first < last) {
      act(first, last, number(0));  // pairs for which no colour was left share bodies
    }
  }
}

// act(begin, end) for all of these batches, which ascend
template <class Act>
void PlaneIterative::by_colour(std::span<const int> batches, const Act& act) {
  if (!workers()) return act(0, int(batches.size()));
  const int colours = int(begin_.size()) - 1;
  int first = 0;
  for (int colour = 0; colour < colours; ++colour) {
    const auto end =
        std::lower_bound(batches.begin() + first, batches.end(), begin_[std::size_t(colour) + 1] / kLanes);
    const int last = int(end - batches.begin()), piece = colour + 1 < colours ? kPlaneBatchPiece : last + 1;
    each(workers(), last - first, piece, [&](int from, int to) { act(first + from, first + to); });
    first = last;
  }
}

plane::SubstepConstants PlaneIterative::constants_from(int batch) const {
  plane::SubstepConstants its = constants_;
  if (its.least) its.least += batch;
  return its;
}

// room for what a warm start may find
void PlaneIterative::reserve_seen() {
  const std::size_t lanes = kLanes * (workers() ? std::size_t(kPlaneBatchPiece) : batches_.size());
  const std::size_t pieces = workers() ? batches_.size() / kPlaneBatchPiece + begin_.size() + 1 : 1;
  if (seen_.size() < pieces) seen_.resize(pieces);
  for (Seen& seen : seen_) seen.slow.reserve(lanes), seen.fast.reserve(lanes);
}

void PlaneIterative::apply_warm_start() {
  for (Seen& seen : seen_) seen.deep = false, seen.slow.clear(), seen.fast.clear();
  by_colour([&](int begin, int end, int number) {
    Seen& seen = seen_[std::size_t(number)];
    seen.deep = plane::warm_start(batches_.data() + begin, end - begin, poses_.data(), middle_.data(),
                                  old_.data(), moving_.data(), constants_, seen.slow, seen.fast);
    for (plane::LaneList* list : {&seen.slow, &seen.fast})
      for (int& lane : *list) lane += kLanes * begin;
  });
  deep_ = false, slow_.clear(), fast_.clear();
  for (const Seen& seen : seen_) {
    deep_ = deep_ || seen.deep;
    slow_.insert(slow_.end(), seen.slow.begin(), seen.slow.end());
    fast_.insert(fast_.end(), seen.fast.begin(), seen.fast.end());
  }
}

void PlaneIterative::iterate_all() {
  by_colour([&](int begin, int end, int) {
    plane::iterate(batches_.data() + begin, end - begin, middle_.data(), moving_.data(),
                   constants_from(begin));
  });
}

// how many pairs these were
int PlaneIterative::iterate_active() {
  std::atomic<int> pairs = 0;
  const std::vector<int>& groups = active_bodies_.groups;
  if (groups.empty()) {
    // a number of each piece's own: threads would wait for each other at one
    static_assert(kActiveBatchPiece >= kPlaneBatchPiece,
                  "there are as many numbers as pieces of a warm start");
    iterated_.assign(seen_.size(), 0);
    by_colour(
        [&](int begin, int end, int number) {
          iterated_[std::size_t(number)] =
              plane::iterate(batches_.data() + begin, nullptr, end - begin, middle_.data(), moving_.data(),
                             constants_from(begin), active_bodies_);
        },
        kActiveBatchPiece);
    pairs = std::accumulate(iterated_.begin(), iterated_.end(), 0);
  } else {
    by_colour(groups, [&](int begin, int end) {
      pairs += plane::iterate(batches_.data(), groups.data() + begin, end - begin, middle_.data(),
                              moving_.data(), constants_, active_bodies_);
    });
  }
  plane::activate_next(active_bodies_);
  return pairs;
}

void PlaneIterative::iterate_last(Contact<D>* contacts) {
  by_colour([&](int begin, int end, int) {
    plane::iterate_last(batches_.data() + begin, end - begin, middle_.data(), moving_.data(),
                        constants_from(begin), contacts);
  });
}

void PlaneIterative::project_all(double share, AllowedOverlap allowed) {
  by_colour([&](int begin, int end, int) {
    plane::project(batches_.data() + begin, projections_.data() + begin, end - begin, poses_.data(),
                   push_.data(), share, allowed);
  });
}

}  // namespace obscura::sim
