#pragma once

#include <memory>

namespace obscura::sim {

/// Threads that share the loops of one caller. They end with this and sleep while there is nothing to do. A
/// caller never waits for a thread that has not come: it does itself what nobody has begun, so a loop ends in
/// a forked process too, where the threads are missing.
class Workers {
 public:
  /// `threads` of them, the caller among them; one at least.
  explicit Workers(int threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int threads() const;

  /// act(begin, end) for all of 0 .. count-1, in pieces that begin at multiples of `piece`, at once and in
  /// any order. What one call writes no other may read, or write otherwise; then the result does not hang on
  /// the number of threads. From within a loop, or while another caller's is under way: one call for all of
  /// it. What a call throws is thrown, that of the first piece, once the others are done.
  template <class Act>
  void each(int count, int piece, const Act& act) {
    const auto call = [](const void* its, int begin, int end) {
      (*static_cast<const Act*>(its))(begin, end);
    };
    share(count, piece, call, &act);
  }

 private:
  using Call = void (*)(const void* act, int begin, int end);
  struct Crew;

  void share(int count, int piece, Call call, const void* act);

  std::shared_ptr<Crew> crew_;
};

/// The same by threads that there may be none of: then one call for all.
template <class Act>
void each(Workers* workers, int count, int piece, const Act& act) {
  if (workers) return workers->each(count, piece, act);
  if (count > 0) act(0, count);
}

}  // namespace obscura::sim
