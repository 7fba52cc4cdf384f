#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace obscura {

/// Whether somebody promised that all that tests need is installed, as script/test does, which installs it.
inline bool promised() { return std::getenv("OBSCURA_TEST_WHOLE") != nullptr; }

/// Whether the shell knows this command.
inline bool installed(const std::string& command) {
  return std::system(("command -v " + command + " >/dev/null").c_str()) == 0;
}

}  // namespace obscura

/// What a test cannot do without, and the Debian packages that have it: where it is missing the test is
/// skipped; it fails where it was promised, for there a skip would hide a fault.
#define OBSCURA_NEEDS(there, packages)                                      \
  do {                                                                      \
    if (!(there)) {                                                         \
      if (::obscura::promised()) FAIL() << "it was promised: " << packages; \
      GTEST_SKIP() << "needs " << packages;                                 \
    }                                                                       \
  } while (false)

/// The same of what `script/test all` tries: where all is not asked for the test is skipped.
#define OBSCURA_LONG(packages, there)                                                                 \
  do {                                                                                                \
    if (!std::getenv("OBSCURA_TEST_ALL")) GTEST_SKIP() << "script/test all tries this: " << packages; \
    OBSCURA_NEEDS(there, packages);                                                                   \
  } while (false)
