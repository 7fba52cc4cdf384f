#pragma once

namespace obscura::sim {

/// A root of f between two places where f has unlike signs, by false position; an end that stays counts half
/// from its second time on, so that both come to the root (the Illinois rule).
/// Source: Dowell and Jarratt, A modified regula falsi method for computing the root of an equation, BIT 11
/// (1971).
class FalsePosition {
 public:
  /// f(low) = at_low, f(high) = at_high; either may be infinite: then the middle is tried.
  FalsePosition(double low, double at_low, double high, double at_high)
      : low_(low), high_(high), at_low_(at_low), at_high_(at_high), rises_(at_high > 0) {}

  double low() const { return low_; }
  double high() const { return high_; }

  /// Where to look next: between both.
  double next() const {
    const double x = (low_ * at_high_ - high_ * at_low_) / (at_high_ - at_low_);
    return x > low_ && x < high_ ? x : 0.5 * (low_ + high_);
  }

  /// f(x) = value, x between both.
  void put(double x, double value) {
    const bool to_high = (value > 0) == rises_;
    if (to_high) {
      if (last_ > 0) at_low_ *= 0.5;
      high_ = x, at_high_ = value;
    } else {
      if (last_ < 0) at_high_ *= 0.5;
      low_ = x, at_low_ = value;
    }
    last_ = to_high ? 1 : -1;
  }

 private:
  double low_, high_, at_low_, at_high_;
  bool rises_;
  int last_ = 0;  // which end was put last
};

}  // namespace obscura::sim
