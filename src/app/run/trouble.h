#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "sim/model/trouble.h"
#include "sim/step/run.h"

namespace obscura::app {

/// "at t = 1.234 s the velocity of crate is not a number", with its likely cause.
std::string text(const sim::Trouble& trouble);

/// Says, on standard error, where the steps of a scene are too long for its springs or drag.
void warn_of_steps(const scene::Scene& scene);

/// Says, on standard error, which letters of the words drawn so far are boxes, for the fonts have them not.
void warn_of_letters(const scene::Scene& scene);

/// What makes a run so far less exact: one line for each limit of its solver's work that a step has met.
std::vector<std::string> limit_notes(const sim::Run& run);

/// Says these, on standard error.
void tell_limits(const scene::Scene& scene, const std::vector<std::string>& notes);

/// A run that could not go on.
struct TroubleError : std::runtime_error {
  /// `kept`: the part of the film that exists, or nothing.
  TroubleError(const std::string& scene, const sim::Trouble& of, const std::string& kept);
  sim::Trouble trouble;
};

}  // namespace obscura::app
