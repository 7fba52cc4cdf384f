#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "draw/picture/pace.h"
#include "sim/math/rational.h"

namespace obscura::app {

/// The longest duration that a scene may have, s.
inline constexpr sim::Rational kLongest{1'000'000, 1};

/// One frame to be made: its number in the whole film, and the exact instant it shows.
struct Shot {
  std::int64_t frame = 0;
  sim::Rational time;  // s of the run
};

/// When the film shows a shot, s of the film: by its number, or where that is not of its instant, as a
/// still's may be, when its instant is first shown.
double film_time(const Shot& shot, sim::Rational fps, const draw::Pace& speed);

/// Which frames of a film are wanted, without listing them: frame n is at exactly n / fps of the film, and
/// shows the instant of the run that `speed` brings there.
class Shots {
 public:
  /// Every frame of a film of `duration` seconds of the run: at its own speed ceil(duration * fps) of them.
  static Shots film(sim::Rational duration, sim::Rational fps, const draw::Pace& speed = {});
  /// The one instant `time` of the run, whichever frame it would be nearest to.
  static Shots still(sim::Rational time, sim::Rational fps, const draw::Pace& speed = {});
  /// Several stills, in the order of time.
  static Shots stills(std::vector<sim::Rational> times, sim::Rational fps, const draw::Pace& speed = {});
  /// The one shot again: its frame, where that shows its instant, and else its instant alone.
  static Shots again(const Shot& shot, sim::Rational fps, const draw::Pace& speed = {});

  /// Only those that show an instant in [from, to), s of the run. Throws UsageError where none is left.
  void between(sim::Rational from, sim::Rational to);
  /// Only the numbers that `list` names: "1,3,5..9". Throws UsageError where it cannot be read or names a
  /// frame that is not there; `asked` is what gave the list, for the message.
  void only(const std::string& list, const char* asked = "--frames");

  std::int64_t size() const { return size_; }
  Shot operator[](std::int64_t i) const;
  sim::Rational fps() const { return fps_; }
  /// The largest frame number, for the width of a name.
  std::int64_t last_frame() const;
  /// The text that only() reads: "0..599". Empty for stills.
  std::string text() const;

 private:
  sim::Rational instant(std::int64_t frame) const { return speed_.world(sim::rational(frame) / fps_); }
  std::int64_t first_at(sim::Rational time) const;
  std::int64_t frame_of(sim::Rational time) const;

  sim::Rational fps_{60, 1};
  draw::Pace speed_;
  std::vector<std::pair<std::int64_t, std::int64_t>> ranges_;  // [first, last]
  std::int64_t size_ = 0;
  std::vector<sim::Rational> instants_;  // of stills
};

/// Instants as a person lists them: "0,0.5,2" or a range "0:1:0.1" (both ends). Throws UsageError.
std::vector<sim::Rational> instants(const std::string& list);

}  // namespace obscura::app
