#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "draw/picture/list.h"

namespace obscura::page {

/// A face as in a style sheet: its family, weight (400: regular) and slant.
struct FaceName {
  std::string family;
  int weight = 400;
  bool italic = false;
};

/// Reads it from the face's file. Throws page::Error.
const FaceName& face_name(draw::Face face);

/// A font file with these glyphs of a face alone; empty where this build cannot make one.
std::vector<std::uint8_t> subset(draw::Face face, const std::set<std::uint32_t>& characters);

}  // namespace obscura::page
