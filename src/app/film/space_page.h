#pragma once

#include <nlohmann/json.hpp>

#include "draw/picture/list.h"
#include "draw/space/space.h"
#include "page/reel.h"
#include "sim/model/snapshot.h"

namespace obscura::app {

/// What a page that draws space itself needs: forms and colours of bodies, the room, the light; and frame by
/// frame how bodies are turned and how cameras see.
class SpacePage {
 public:
  /// `part`: of a page of several runs, which; `panel`: the part of the page that it has.
  SpacePage(const draw::SpaceStage& stage, int part, const draw::Rect& panel, page::Reel& reel);

  void add(const sim::Snapshot& now, const draw::Picture& picture);
  nlohmann::ordered_json json() const { return json_; }

 private:
  static constexpr int kLens = 16;  // numbers of one
  page::Reel& reel_;
  int part_;
  int poses_ = -1, lenses_ = -1;  // the first number of each
  std::vector<Eigen::Vector4d> turns_;
  nlohmann::ordered_json json_;
};

}  // namespace obscura::app
