#pragma once

#include <string>
#include <vector>

#include "app/run/shots.h"
#include "media/movie.h"
#include "scene/scene.h"

namespace obscura::app {

/// What a movie says for those who do not see its words, or look for a place in it.
struct Subtitles {
  std::vector<media::TextCue> captions;  // one after another, none where nothing is said
  std::vector<media::Chapter> chapters;  // from its cards; none without cards
};

/// The captions and chapters of the first `frames` of a film's shots, to the frame.
Subtitles subtitles(const scene::Scene& scene, const Shots& shots, std::int64_t frames);

/// Captions as WebVTT.
std::string webvtt(const std::vector<media::TextCue>& captions);

/// The name of a movie's captions: "film.vtt" beside "film.mp4".
std::string captions_of(const std::string& movie);

}  // namespace obscura::app
