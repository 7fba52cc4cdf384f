#pragma once

#include <string>

namespace obscura::app {

/// From now on this process gets at most `bytes` of memory, or what it was allowed already if that is less:
/// asking for more throws std::bad_alloc. The kernel keeps it (RLIMIT_DATA), libraries included.
void hold_memory(double bytes);

/// The default limit: nine tenths of this machine's memory, or of that which its control group allows.
double most_memory();

/// The memory that this process may use, bytes.
double memory_limit();

/// Throws std::bad_alloc unless there is memory left to draw and encode so many pixels: asked before OpenGL
/// is, which does not survive being refused.
void require_memory_to_draw(double pixels);

/// "out of memory: the limit is 2.0 GB".
std::string out_of_memory();

/// If memory ends inside a library that does not check for it, the program still ends with that line and exit
/// code 4.
void survive_libraries();

/// "2GB", "1.5 GiB", "500M": bytes. Throws UsageError.
double parse_bytes(const std::string& text);

/// "812 kB", "3.2 MB", "1.25 GB".
std::string bytes_text(double bytes);

}  // namespace obscura::app
