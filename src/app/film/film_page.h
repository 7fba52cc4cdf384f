#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "app/film/film.h"
#include "app/run/shots.h"
#include "scene/scene.h"

namespace obscura::app {

/// A film that becomes a page, frame by frame: one HTML file (page/html.h). Its pictures are no pixels; but
/// for the surfaces of space in the first, which is shown where no script runs.
class PageFilm {
 public:
  /// Throws UsageError for a film that a page cannot show.
  PageFilm(const scene::Scene& scene, const Shots& shots);
  ~PageFilm();

  /// Simulates and adds the next frame. False after the last, where a signal asks for an end, or where the
  /// run cannot go on.
  bool next();
  std::int64_t frames() const;
  const std::optional<sim::Trouble>& trouble() const;

  /// The page of the frames so far, of one at least; of all with what happens in the run, which is simulated
  /// once more for it. `context`: draws the first picture's surfaces. Throws gl::Error.
  std::string html(const gl::ContextOptions& context);
  /// The same for a browser on this machine: it asks for the next version of itself (app/commands/watch.cpp).
  std::string watched();

 private:
  std::string html(bool watched, const std::vector<std::uint8_t>& still);

  struct Making;
  std::unique_ptr<Making> making_;
};

/// Writes the shots of a scene as a page that plays them. Only
/// the shots' progress and the file's rules are heeded of `options`. Returns an exit code; throws the errors
/// of the rooms.
int film_page(const scene::Scene& scene, const Shots& shots, const std::string& path,
              const FilmOptions& options);

}  // namespace obscura::app
