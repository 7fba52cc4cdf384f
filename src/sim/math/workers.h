#pragma once

#include <memory>

namespace obscura::sim {

/// Threads that share the loops of one caller. They sleep while there is no loop, and end when this is
/// destroyed. The caller does all pieces that no thread has begun, so it never waits for a thread that is
/// late. In a forked process, which has no such threads, it does them all.
class Workers {
 public:
  /// `threads` threads, the caller included; at least one. If the system refuses some, those that began do
  /// all.
  explicit Workers(int threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// As many as were asked for.
  int threads() const;

  /// act(begin, end) for all of 0 .. count-1, in pieces that begin at multiples of `piece`, at once and in
  /// any order. What one call changes, no other call may read or change; then the result does not depend on
  /// the number of threads. Within a loop, or while the loop of another caller runs, it is one call for all.
  /// If calls throw, the exception of the first piece is thrown after all pieces are done.
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

/// The same where `workers` may be null: then one call for all.
template <class Act>
void each(Workers* workers, int count, int piece, const Act& act) {
  if (workers) return workers->each(count, piece, act);
  if (count > 0) act(0, count);
}

}  // namespace obscura::sim
