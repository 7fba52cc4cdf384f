#pragma once

#include <string>

namespace obscura::page {

/// The player's modules as one script, its style, and its page with names between @ to be replaced
/// (page/player/).
extern const std::string kPlayerScript, kPlayerStyle, kPlayerPage;

}  // namespace obscura::page
