#pragma once

#include <string>

namespace obscura::scene {

/// The language's JSON Schema (draft 7), and the page that documents every key: both from the one table of
/// keys.
std::string json_schema();
std::string keys_page();

/// The short commented scene that `obscura new NAME` writes.
std::string new_scene(const std::string& name);

}  // namespace obscura::scene
