#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

namespace obscura::app {

// Ordered jobs, parallel work, ordered results: one thread simulates segments in order, several workers draw
// and encode them, and one thread joins the results in order. At most workers + 2 jobs are under way, so that
// memory is bounded by the workers and not by the length of the film.

template <class Job, class Result>
struct Conduct {
  std::function<std::optional<Job>()> produce;       // on the caller's thread; nothing: the end
  std::function<std::function<Result(Job)>()> hire;  // once on each worker's own thread
  std::function<bool(Result)> consume;               // on the caller's thread, in order; false: stop
  std::function<void()> wait = [] {};                // on the caller's thread, about ten times a second
};

/// Runs all jobs to the end. Rethrows the first exception, in the order of the jobs.
template <class Job, class Result>
void conduct(const Conduct<Job, Result>& parts, int workers) {
  struct Finished {
    std::optional<Result> result;
    std::exception_ptr error;
  };
  std::mutex mutex;
  std::condition_variable_any jobs_changed, outcomes_changed;
  std::deque<std::pair<long, Job>> jobs;
  std::map<long, Finished> outcomes;
  long made = 0, taken = 0;

  auto labour = [&](std::stop_token stop) {
    std::function<Result(Job)> work;
    std::exception_ptr unfit;
    try {
      work = parts.hire();
    } catch (...) {
      unfit = std::current_exception();
    }
    for (;;) {
      std::unique_lock lock(mutex);
      if (!jobs_changed.wait(lock, stop, [&] { return !jobs.empty(); })) return;
      auto [number, job] = std::move(jobs.front());
      jobs.pop_front();
      lock.unlock();
      Finished outcome;
      try {
        if (unfit) std::rethrow_exception(unfit);
        outcome.result = work(std::move(job));
      } catch (...) {
        outcome.error = std::current_exception();
      }
      lock.lock();
      outcomes.emplace(number, std::move(outcome));
      outcomes_changed.notify_one();
    }
  };

  std::vector<std::jthread> crew;
  for (int i = 0; i < workers; ++i) crew.emplace_back(labour);
  bool more = true;
  for (;;) {
    // keep every worker busy and one job ahead, then take what is next in order
    while (more && made - taken < workers + 2) {
      std::optional<Job> job = parts.produce();
      if (!job) {
        more = false;
        break;
      }
      const std::lock_guard lock(mutex);
      jobs.emplace_back(made++, std::move(*job));
      jobs_changed.notify_one();
    }
    if (taken == made) return;
    std::unique_lock lock(mutex);
    while (!outcomes_changed.wait_for(lock, std::chrono::milliseconds(100),
                                      [&] { return outcomes.count(taken) > 0; })) {
      lock.unlock();
      parts.wait();
      lock.lock();
    }
    Finished outcome = std::move(outcomes.extract(taken++).mapped());
    lock.unlock();
    if (outcome.error) std::rethrow_exception(outcome.error);
    if (!parts.consume(std::move(*outcome.result))) return;
    parts.wait();
  }
}

}  // namespace obscura::app
