#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "app/console/command.h"
#include "app/run/diagnosis.h"
#include "media/pixels.h"
#include "scene/error.h"

namespace obscura::app {

/// How a command says what it found: for a person; for a program, as one JSON object on standard output
/// alone (docs/json.md); or for a workflow of GitHub's, as for a person and with annotations and a summary.
enum class Format { text, json, github };

/// --format.
void add_format(const Command& command, Format& format);

/// The first keys of every object: the version, the command, the exit code.
nlohmann::ordered_json json_head(const char* command, int exit);

/// The parts that several have in common.
nlohmann::ordered_json json_of(const media::Difference& difference);
nlohmann::ordered_json json_of(const Cause& cause);
nlohmann::ordered_json json_of(const scene::Error& error);

/// As text, with the end of its line. Bytes that are not UTF-8 are replaced.
std::string text_of(const nlohmann::ordered_json& json);

}  // namespace obscura::app
