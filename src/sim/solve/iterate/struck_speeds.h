#pragma once

#include <algorithm>
#include <vector>

namespace obscura::sim {

/// How fast bodies may become within a step by what strikes them, m/s. Sleeping bodies wake that such a body
/// may reach, as it would strike them as walls. Something light leaves at up to twice the speed of what
/// strikes it, and no body strikes faster than the fastest.
class StruckSpeeds {
 public:
  /// Of `bodies` bodies, that are at rest until begin() says their speeds.
  void clear(int bodies) { speeds_.assign(std::size_t(bodies), 0), fastest_ = 0; }
  void begin(int body, double speed) {
    speeds_[std::size_t(body)] = speed;
    fastest_ = std::max(fastest_, speed);
  }
  double speed(int body) const { return speeds_[std::size_t(body)]; }

  /// The slower of two that would become faster where they meet; -1: none would.
  int struck(int a, int b) const {
    const int slower = speed(a) < speed(b) ? a : b;
    return leaves(slower == a ? b : a) > speed(slower) ? slower : -1;
  }
  /// They meet, and the one that struck() names is as fast as that makes it.
  void strike(int by, int body) { speeds_[std::size_t(body)] = leaves(by); }

 private:
  double leaves(int by) const { return 2 * std::min(fastest_, speed(by)); }

  std::vector<double> speeds_;
  double fastest_ = 0;
};

}  // namespace obscura::sim
