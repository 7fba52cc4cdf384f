#pragma once

#include <cstdint>
#include <string>

namespace obscura::app {

/// One of several equal shares of a work. Its pieces count from 0; a share has consecutive ones.
struct Shard {
  std::int64_t number = 1, of = 1;  // the first is 1

  /// Its pieces of `n` are [begin, end).
  std::int64_t begin(std::int64_t n) const { return cut(number - 1, n); }
  std::int64_t end(std::int64_t n) const { return cut(number, n); }

 private:
  std::int64_t cut(std::int64_t k, std::int64_t n) const { return n / of * k + n % of * k / of; }
};

/// "2/4". Throws UsageError.
Shard parse_shard(const std::string& text);

}  // namespace obscura::app
