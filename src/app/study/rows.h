#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/film/spent.h"

namespace obscura::app {

/// How the rows of a sweep are written: for tables (RFC 4180, with line feeds alone), or one JSON object a
/// line.
enum class RowForm { csv, jsonl };

/// A row's cells as text: numbers and other JSON values stand for themselves, the rest are words. Empty:
/// there is none.
std::string row(RowForm form, const std::vector<std::string>& heads, const std::vector<std::string>& cells);

/// The line of heads that a table starts with; JSON lines have none.
std::string head(RowForm form, const std::vector<std::string>& heads);

/// A file that grows row by row, whole rows at a time, under its partial name (sweep.partial.csv), which is
/// renamed to its own when it is whole; or standard output. A second process that would write the same is
/// refused. Every failure throws media::Error naming the file.
class RowFile {
 public:
  /// None: standard output. `go_on`: with the whole rows that an earlier process left; else without them, and
  /// unless `anew` they are refused to be lost where they are more than a minute of work.
  enum class Begin { fresh, go_on, anew };
  RowFile(const std::optional<std::string>& path, Begin begin);
  ~RowFile();
  RowFile(const RowFile&) = delete;
  RowFile& operator=(const RowFile&) = delete;

  /// The whole lines that were left there.
  struct Earlier {
    std::int64_t lines = 0;
    std::string first, last;  // without their line feeds
  };
  const Earlier& earlier() const { return earlier_; }
  void add(const std::string& line);
  /// Renames it into place.
  void finish();
  /// The name under which it grows; "standard output".
  const std::string& name() const { return name_; }

 private:
  std::string path_, name_;
  Earlier earlier_;
  int descriptor_ = -1;
  std::optional<Spent> spent_;
};

}  // namespace obscura::app
