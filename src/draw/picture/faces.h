#pragma once

#include <array>

#include "draw/picture/list.h"

struct FT_LibraryRec_;
struct FT_FaceRec_;

namespace obscura::draw {

/// The typefaces as FreeType has them open, each from its first use on. Used from one thread at a time.
class OpenFaces {
 public:
  /// Throws draw::Error where FreeType cannot be started.
  OpenFaces();
  ~OpenFaces();
  OpenFaces(const OpenFaces&) = delete;
  OpenFaces& operator=(const OpenFaces&) = delete;

  /// Throws draw::Error where its font is missing or cannot be read.
  FT_FaceRec_* open(Face face);

 private:
  FT_LibraryRec_* library_ = nullptr;
  std::array<FT_FaceRec_*, 6> faces_{};
};

}  // namespace obscura::draw
