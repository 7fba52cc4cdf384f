#pragma once

#include <string>

namespace obscura::app {

/// From now on this process gets at most `bytes` of memory, or what it was allowed already if that is less:
/// asking for more throws std::bad_alloc. The kernel keeps it (RLIMIT_DATA), libraries included.
void hold_memory(double bytes);

/// Nine tenths of what this machine has, or of what its control group may have: what is held to unless told.
double most_memory();

/// The memory that this process may use, bytes.
double memory_limit();

/// Throws std::bad_alloc unless there is memory left to draw and encode so many pixels: asked before OpenGL
/// is, which does not survive being refused.
void require_memory_to_draw(double pixels);

/// "out of memory: the limit is 2.0 GB".
std::string out_of_memory();

/// Where memory ends inside a library that does not check for it, the program ends with that line and exit
/// code 4 all the same.
void survive_libraries();

/// "2GB", "1.5 GiB", "500M": bytes. Throws UsageError.
double parse_bytes(const std::string& text);

/// "812 kB", "3.2 MB", "1.25 GB".
std::string bytes_text(double bytes);

}  // namespace obscura::app
