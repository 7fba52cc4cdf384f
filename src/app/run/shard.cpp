#include "app/run/shard.h"

#include <charconv>

#include <fmt/format.h>

#include "app/console/exit.h"

namespace obscura::app {

Shard parse_shard(const std::string& text) {
  constexpr std::int64_t kMost = 1'000'000;
  Shard shard;
  const char* end = text.data() + text.size();
  const auto i = std::from_chars(text.data(), end, shard.number);
  if (i.ec == std::errc() && i.ptr != end && *i.ptr == '/') {
    const auto n = std::from_chars(i.ptr + 1, end, shard.of);
    if (n.ec == std::errc() && n.ptr == end && shard.number >= 1 && shard.number <= shard.of &&
        shard.of <= kMost)
      return shard;
  }
  throw UsageError(fmt::format("--shard {}: expected I/N, the I-th of N, as in 2/4", text));
}

}  // namespace obscura::app
