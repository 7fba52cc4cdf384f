#pragma once

#include <string>

#include "app/film/film.h"
#include "app/run/shots.h"
#include "scene/scene.h"

namespace obscura::app {

/// Writes the shots of a scene as a PDF of one page each, vectors but for lit surfaces. Returns an exit code;
/// throws the errors of the rooms.
int film_pages(const scene::Scene& scene, const Shots& shots, const std::string& path,
               const FilmOptions& options);

}  // namespace obscura::app
