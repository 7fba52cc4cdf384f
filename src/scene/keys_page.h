#pragma once

namespace obscura::scene {

/// What the page of keys says before its tables, as Markdown: keys_page.md, embedded by keys_page.cmake.
extern const char* const kKeysPageOpening;

}  // namespace obscura::scene
