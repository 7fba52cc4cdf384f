#pragma once

namespace obscura::media {

/// A shared library by its name, as dlopen gives it; null where there is none. Throws std::bad_alloc where
/// there is no memory for it.
void* opened(const char* library);

}  // namespace obscura::media
