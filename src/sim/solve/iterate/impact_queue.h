#pragma once

#include <algorithm>
#include <span>
#include <vector>

// Impacts within a substep in the order of time, in the plane and in space.

namespace obscura::sim {

/// Impacts that are due, each predicted for bodies that no other strikes before.
class ImpactQueue {
 public:
  struct Due {
    double when = 0;  // s from the start of the substep
    int number = 0;   // of one instant, the lowest comes first
    int rounds = 0;   // impacts of its bodies when it was predicted: outdated once they had another

    // so that the next is the top of a heap
    bool operator<(const Due& other) const {
      return when != other.when ? when > other.when : number > other.number;
    }
  };

  void clear() { due_.clear(); }
  bool empty() const { return due_.empty(); }
  std::size_t size() const { return due_.size(); }
  void push(double when, int number, int rounds) {
    due_.push_back({when, number, rounds});
    std::push_heap(due_.begin(), due_.end());
  }
  /// Takes out the next.
  Due pop() {
    std::pop_heap(due_.begin(), due_.end());
    const Due next = due_.back();
    due_.pop_back();
    return next;
  }

 private:
  std::vector<Due> due_;
};

/// For each body that moves its pairs or contacts, ascending.
class ByBody {
 public:
  /// `sides(i, act)`: calls act(body) for each body of number i that moves.
  template <class Sides>
  void build(int bodies, int count, Sides&& sides) {
    first_.assign(std::size_t(bodies) + 2, 0);
    for (int i = 0; i < count; ++i) sides(i, [&](int body) { ++first_[std::size_t(body) + 2]; });
    for (std::size_t i = 2; i < first_.size(); ++i) first_[i] += first_[i - 1];
    numbers_.resize(std::size_t(first_.back()));
    for (int i = 0; i < count; ++i)
      sides(i, [&](int body) { numbers_[std::size_t(first_[std::size_t(body) + 1]++)] = i; });
  }
  std::span<const int> of(int body) const {
    return {numbers_.data() + first_[std::size_t(body)], numbers_.data() + first_[std::size_t(body) + 1]};
  }

 private:
  std::vector<int> first_, numbers_;
};

}  // namespace obscura::sim
