#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/film/store.h"
#include "media/movie.h"

namespace obscura::app {

/// The part of a film that its drawn segments make.
struct Joining {
  std::int64_t takes = 0;                // the first so many, those that are missing left out
  std::optional<std::string> instead{};  // the name of a film that is not whole
  std::optional<std::string> cut{};      // a part that goes behind them
};

/// Joins takes into the movie by stream copy; its bytes follow from theirs. Returns the number of frames.
/// Throws media::Error, also where takes are not of one film.
std::int64_t join(Store& store, const std::string& movie, const Joining& joining);

}  // namespace obscura::app
