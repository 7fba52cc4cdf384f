#pragma once

#include <stdexcept>
#include <string>

#include "scene/scene.h"
#include "sim/model/trouble.h"

namespace obscura::app {

/// "at t = 1.234 s the velocity of crate is not a number", with its likely cause.
std::string text(const sim::Trouble& trouble);

/// Says, on standard error, where the steps of a scene are too long for its springs or drag.
void warn_of_steps(const scene::Scene& scene);

/// A run that could not go on.
struct TroubleError : std::runtime_error {
  /// `kept`: the part of the film that exists, or nothing.
  TroubleError(const std::string& scene, const sim::Trouble& of, const std::string& kept);
  sim::Trouble trouble;
};

}  // namespace obscura::app
