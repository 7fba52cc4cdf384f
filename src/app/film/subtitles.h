#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/run/shots.h"
#include "media/movie.h"
#include "scene/scene.h"

namespace obscura::app {

/// What a movie says for those who do not see its words, or look for a place in it.
struct Subtitles {
  std::vector<media::TextCue> captions;  // one after another, none where nothing is said
  std::vector<media::Chapter> chapters;  // from its cards and marks; none without them
};

/// The captions and chapters of the first `frames` of a film's shots, to the frame. `marks`: those that its
/// run comes to, s, in the order of time. A mark less than a second of the film behind a chapter begins none.
Subtitles subtitles(const scene::Scene& scene, const Shots& shots, std::int64_t frames,
                    const std::vector<std::pair<std::string, sim::Rational>>& marks = {});

/// Captions as WebVTT.
std::string webvtt(const std::vector<media::TextCue>& captions);

/// The name of a movie's captions: "film.vtt" beside "film.mp4".
std::string captions_of(const std::string& movie);

}  // namespace obscura::app
