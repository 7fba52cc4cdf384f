#include "sim/math/workers.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace obscura::sim {

namespace {

constexpr int kSpins = 20000;  // looks for a loop before a thread sleeps: some tenths of a millisecond

void relax() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

// The pieces of one thread that no thread has begun: from `begin` on, before `end`. Both are in one word, so
// that each piece is taken once. The thread itself takes the first piece, so that it uses the same memory in
// each loop. A thread whose own pieces are all taken takes the last piece of another.
struct Share {
  static constexpr int kBits = 20;
  static constexpr std::uint64_t kMost = (1u << kBits) - 1;

  alignas(64) std::atomic<std::uint64_t> word{0};

  void set(std::uint64_t begin, std::uint64_t end) { word = begin << kBits | end; }
  // -1: none is left
  int take(bool first) {
    std::uint64_t at = word.load(), begin = 0, end = 0;
    do {
      begin = at >> kBits, end = at & kMost;
      if (begin >= end) return -1;
    } while (!word.compare_exchange_weak(at, first ? at + (1u << kBits) : at - 1));
    return int(first ? begin : end - 1);
  }
};

}  // namespace

struct Workers::Crew {
  std::vector<Share> shares;  // one a thread; the caller's first
  alignas(64) std::atomic<std::uint64_t> loop{0};
  alignas(64) std::atomic<int> done{0};  // pieces of the loop
  alignas(64) std::atomic<std::uint32_t> calls{0};
  std::atomic<int> asleep{0};
  std::atomic<bool> ends{false}, busy{false};
  // the loop: written before its shares are, and while one of its pieces is under way it stays
  Call call = nullptr;
  const void* act = nullptr;
  int count = 0, piece = 0;
  std::mutex noting;
  int failed = -1;  // the first piece that has thrown, and what
  std::exception_ptr error;

  explicit Crew(int size) : shares(std::size_t(size)) {}

  // does pieces of a thread's own share, then of the others', until none is left
  void work(int own) {
    int did = 0;
    const int all = int(shares.size());
    for (int i = 0; i < all; ++i) {
      Share& share = shares[std::size_t((own + i) % all)];
      for (int at = share.take(i == 0); at >= 0; at = share.take(i == 0)) perform(at), ++did;
    }
    if (did > 0) done.fetch_add(did, std::memory_order_release);
  }

  void perform(int at) {
    const int begin = at * piece;
    try {
      call(act, begin, std::min(begin + piece, count));
    } catch (...) {
      const std::lock_guard lock(noting);
      if (failed < 0 || at < failed) failed = at, error = std::current_exception();
    }
  }

  void serve(int own) {
    std::uint64_t seen = 0;
    while (!ends) {
      int spins = 0;
      while (loop.load() == seen && spins < kSpins) relax(), ++spins;
      if (spins < kSpins) {
        seen = loop.load();
        work(own);
        continue;
      }
      const std::uint32_t heard = calls.load();
      ++asleep;
      // a loop that began meanwhile has either seen that this thread sleeps, or is seen here
      if (loop.load() == seen && !ends) calls.wait(heard);
      --asleep;
    }
  }

  void wake() {
    ++calls;
    calls.notify_all();
  }

  void run() {
    const int pieces = (count + piece - 1) / piece, all = int(shares.size());
    failed = -1, error = nullptr, done = 0;
    for (int i = 0; i < all; ++i) {
      const auto begins = [&](int thread) { return std::uint64_t(std::int64_t(pieces) * thread / all); };
      shares[std::size_t(i)].set(begins(i), begins(i + 1));
    }
    ++loop;
    if (asleep > 0) wake();
    work(0);
    for (int i = 0; done.load(std::memory_order_acquire) < pieces; ++i)
      i < kSpins ? relax() : std::this_thread::yield();
  }
};

// The threads are detached, and each keeps the crew alive. So the destructor does not wait for them: in a
// forked process they do not exist.
Workers::Workers(int threads) : crew_(std::make_shared<Crew>(std::max(1, threads))) {
  try {
    for (int i = 1; i < threads; ++i) std::thread([crew = crew_, i] { crew->serve(i); }).detach();
  } catch (const std::system_error&) {
    // the system has no more threads: those that began do the pieces of the others
  }
}

Workers::~Workers() {
  crew_->ends = true;
  crew_->wake();
}

int Workers::threads() const { return int(crew_->shares.size()); }

void Workers::share(int count, int piece, Call call, const void* act) {
  if (count <= 0) return;
  Crew& it = *crew_;
  bool free = false;
  if (count <= piece || it.shares.size() == 1 || !it.busy.compare_exchange_strong(free, true))
    return call(act, 0, count);
  it.call = call, it.act = act, it.count = count;
  it.piece = piece * (1 + count / piece / int(Share::kMost));  // still a multiple
  it.run();
  const std::exception_ptr error = std::move(it.error);
  it.busy = false;
  if (error) std::rethrow_exception(error);
}

}  // namespace obscura::sim
