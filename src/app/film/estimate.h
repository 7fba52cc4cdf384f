#pragma once

#include <cstdint>
#include <string>

#include "app/film/output.h"
#include "app/run/shots.h"
#include "scene/scene.h"

namespace obscura::app {

/// The resources that a film needs. All but the number of frames is estimated.
struct Needs {
  std::int64_t frames = 0;
  double disk = 0;      // bytes
  double simulate = 0;  // s, as its first steps let expect: what piles up later takes longer
  double draw = 0;      // s of one core, encoding included
  double begin = 0;     // s until a worker draws
  double fixed = 0;     // bytes of memory, however many workers there are
  double worker = 0;    // bytes for each worker more

  /// Bytes of memory with so many workers.
  double memory(int workers) const { return fixed + worker * workers; }
  /// Seconds with so many workers: the steps are one after another, the pictures side by side.
  double seconds(int workers) const;
};

/// The needs of these shots with this output. Takes `patience` seconds of this thread (and a step at least)
/// to see how long steps take and how much moves.
Needs needs(const scene::Scene& scene, const Shots& shots, const Output& output, double patience);

/// So many workers (0: one a core), or as many as fit into the memory that this process may have. Throws
/// media::Error that says what is needed where not even one does.
int fitting_workers(const scene::Scene& scene, const Needs& needs, int workers);

/// Throws media::Error where `bytes` of memory are more than this process may have.
void refuse_beyond_memory(const scene::Scene& scene, double bytes);

/// "20 s", "12 min", "3.5 h", "9 days".
std::string time_text(double seconds);

}  // namespace obscura::app
