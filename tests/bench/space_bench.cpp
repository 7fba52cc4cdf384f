// What light, shadows and edges cost: a 1080p frame of 200 boxes in space beside the same triangles, flat,
// with the same four samples a pixel. The bar: not more than twice.

#include <benchmark/benchmark.h>

#include "draw/compose/depict.h"
#include "draw/picture/solids.h"
#include "draw/space/camera.h"
#include "gl/renderer.h"

namespace {

using namespace obscura;
using sim::Vec3;

struct BodyCounts {
  sim::SceneInfo cast;
  sim::Snapshot now;
  draw::Look look;

  BodyCounts() {
    cast.dimension = 3, cast.scale = 4;
    cast.walls.push_back({{0, 0, 0}, {0, 1, 0}});
    unsigned state = 1;
    const auto number = [&] {
      state = state * 1664525u + 1013904223u;
      return (state >> 8) / 16777216.0;
    };
    for (int i = 0; i < 200; ++i) {
      sim::SceneInfo::Body who;
      who.kind = sim::ShapeKind::box, who.turns = true, who.mass = 1;
      sim::Snapshot::Body where;
      for (int k = 0; k < 3; ++k) who.half[k] = 0.08 + 0.12 * number();
      where.position = {6 * number() - 3, 0.2 + 2.4 * number(), 4 * number() - 2};
      Eigen::Vector4d turn;
      for (int k = 0; k < 4; ++k) turn[k] = number() - 0.5;
      where.orientation = Eigen::Quaterniond(turn).normalized();
      cast.bodies.push_back(who);
      now.bodies.push_back(where);
    }
  }
};

void frame(benchmark::State& state) {
  const bool flat = state.range(0) == 0;
  BodyCounts crowd;
  const draw::Illustrator depictor(crowd.cast, crowd.look, draw::slant(), {{-3, 0, -2}, {3, 2.6, 2}},
                                   16.0 / 9);
  gl::Renderer renderer(1920, 1080);
  const draw::Picture bare = depictor.depict(crowd.now, {});
  for (auto _ : state) {
    draw::Picture picture;
    if (flat) {
      picture = bare;
      picture.moving = {};
      auto solids = std::make_shared<draw::Solids>(*bare.solids[0]);
      solids->casters.clear(), solids->shades.clear();
      picture.solids = {solids};
    } else {
      picture = depictor.depict(crowd.now, {});
    }
    benchmark::DoNotOptimize(renderer.draw(picture).pixels.data());
  }
}
BENCHMARK(frame)->ArgName("lit")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
