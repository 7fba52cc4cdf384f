#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "sim/model/snapshot.h"

namespace obscura::app {

/// Checksums of the states that a film shows, a few kilobytes in its origin: one of all its frames, by which
/// two films are known to show the same, and short ones of frames and bodies, by which the first that
/// differ are found.
class Checksums {
 public:
  /// For a film of `frames` frames, of which this may be a part, and `bodies` bodies.
  Checksums(std::int64_t frames, std::size_t bodies);

  /// Adds frame `index` of the film: the hash of its state (state_hash), and where its bodies are. In order.
  void add(std::int64_t index, const std::string& state, const sim::Snapshot& moment);
  /// Adds the part of the film that follows.
  void append(const Checksums& next);
  /// Nothing follows any more: the frames' hashes become one.
  void close();

  /// How many frames there are.
  std::int64_t frames() const { return frames_; }
  bool operator==(const Checksums&) const = default;

  nlohmann::ordered_json json() const;
  /// Reads the output of json(); none if it is not one.
  static std::optional<Checksums> read(const nlohmann::json& json);

  /// The first difference of two films, by the indices of their frames.
  struct Apart {
    std::int64_t same = -1;             // the last that is the same before the first that differs
    std::optional<std::int64_t> first;  // that differs; none: one without a checksum of its own
    bool ended = false;                 // it differs because one of the films has ended
    bool bodies_known = false;          // there are checksums of bodies
    std::int64_t bodies_at = 0;         // the first frame from `first` on with bodies that differ
    std::vector<std::size_t> bodies;    // they; none: no body is anywhere else
  };
  /// Requires closed ones. None where they are the same.
  static std::optional<Apart> apart(const Checksums& a, const Checksums& b);

 private:
  // rows of two letters each, of the frames 0, each, 2 each, ...
  struct Rows {
    std::int64_t each = 1, width = 0;  // width: letters of a row
    std::string letters;
    bool operator==(const Rows&) const = default;
    std::string_view row(std::int64_t i) const;
    std::int64_t size() const { return width > 0 ? std::int64_t(letters.size()) / width : 0; }
  };
  Checksums() = default;

  std::int64_t frames_ = 0;
  std::string states_;  // the frames' hashes one behind the other; closed: the hash of that
  Rows of_frames_, of_bodies_;
};

/// Checksums of one picture.
Checksums checksums(const std::string& state, const sim::Snapshot& moment);

}  // namespace obscura::app
