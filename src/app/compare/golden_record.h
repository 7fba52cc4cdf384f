#pragma once

#include <map>
#include <string>

#include "app/film/pictures.h"

namespace obscura::app {

/// The record that `[golden] keep = "hash"` keeps of a scene's moments instead of pictures: hashes, as a few
/// lines of JSON.
struct GoldenRecord {
  struct Moment {
    std::string state, pixels;  // beginnings of hashes: of the state as it is printed, of the picture
  };

  std::string scene;                      // the beginning of the hash of the scene's text
  std::string gl;                         // the OpenGL that drew it, and its renderer
  std::map<std::string, Moment> moments;  // by time, as "2.5"

  std::string text() const;
};

/// The record of these pictures. Requires at least one picture, all of one scene.
GoldenRecord record_of(const std::vector<std::string>& times, const std::vector<Pictured>& made);

/// A moment's hashes, as a record has them.
GoldenRecord::Moment moment_of(const Pictured& made);

/// The hash of a picture's size and pixels, as a record has it.
std::string pixel_hash(const media::Image& image);

/// Reads a record. Throws media::Error naming the file where it is none, or cut.
GoldenRecord read_record(const std::string& file);

}  // namespace obscura::app
