#pragma once

#include <stdexcept>

namespace obscura::app {

/// The program's exit codes, the same for every command.
enum Exit : int {
  kDone = 0,
  kDiffers = 1,  // pictures or states differ
  kUsage = 2,
  kScene = 3,
  kFiles = 4,  // files or codec
  kGl = 5,
  kDiverged = 6,
  kInterrupted = 130,
};

/// A command line that cannot be meant.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace obscura::app
