// The run as glTF: where bodies are at its instants, and surfaces that are closed and look outwards.

#include <cmath>
#include <cstring>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "program.h"

namespace obscura::app {
namespace {

using Json = nlohmann::json;

struct Read {
  Json top;
  std::string numbers;

  // accessor `i` as rows of floats
  std::vector<std::vector<float>> rows(int i) const {
    const Json& accessor = top["accessors"][i];
    const Json& view = top["bufferViews"][int(accessor["bufferView"])];
    const std::string type = accessor["type"];
    const std::size_t n = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : 4, count = accessor["count"];
    std::vector<std::vector<float>> all(count, std::vector<float>(n));
    for (std::size_t k = 0; k < count; ++k)
      std::memcpy(all[k].data(), numbers.data() + int(view["byteOffset"]) + 4 * n * k, 4 * n);
    return all;
  }
  std::vector<std::uint32_t> indices(int i) const {
    const Json& accessor = top["accessors"][i];
    const std::size_t count = accessor["count"];
    std::vector<std::uint32_t> all(count);
    std::memcpy(all.data(),
                numbers.data() + int(top["bufferViews"][int(accessor["bufferView"])]["byteOffset"]),
                4 * all.size());
    return all;
  }
  int node(const std::string& name) const {
    for (std::size_t i = 0; i < top["nodes"].size(); ++i)
      if (top["nodes"][i]["name"] == name) return int(i);
    return -1;
  }
  // what animates a node's `path`, and when
  std::pair<std::vector<std::vector<float>>, std::vector<std::vector<float>>> channel(
      int node, const std::string& path) const {
    for (const Json& each : top["animations"][0]["channels"])
      if (each["target"]["node"] == node && each["target"]["path"] == path) {
        const Json& sampler = top["animations"][0]["samplers"][int(each["sampler"])];
        return {rows(sampler["input"]), rows(sampler["output"])};
      }
    return {};
  }
  // the volume that a mesh holds: positive where its triangles look outwards
  double volume(const Json& mesh) const {
    const Json& primitive = mesh["primitives"][0];
    const auto p = rows(primitive["attributes"]["POSITION"]);
    const auto t = indices(primitive["indices"]);
    double sum = 0;
    for (std::size_t k = 0; k < t.size(); k += 3) {
      const auto &a = p[t[k]], &b = p[t[k + 1]], &c = p[t[k + 2]];
      sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
             a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return sum / 6;
  }
};

Read read_glb(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string all((std::istreambuf_iterator<char>(in)), {});
  const auto word = [&](std::size_t at) {
    std::uint32_t w = 0;
    std::memcpy(&w, all.data() + at, 4);
    return w;
  };
  EXPECT_EQ(all.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2u);
  EXPECT_EQ(word(8), all.size());
  const std::size_t json = word(12), numbers = 20 + json;
  EXPECT_EQ(json % 4, 0u);
  EXPECT_EQ(all.substr(numbers + 4, 4), std::string("BIN\0", 4));
  return {Json::parse(all.substr(20, json)), all.substr(numbers + 8, word(numbers))};
}

using Export = Program;

const char* const kThrown = R"(
duration = 1
[room]
size = [6, 4, 6]
[physics]
collision = "handout"
[[box]]
name = "crate"
size = [0.6, 0.4, 0.5]
position = [0.2, 2, 0]
velocity = [1, 3, -0.5]
orientation = [20, 30, 0]
spin = [200, -90, 40]
[[ball]]
name = "ball"
radius = 0.25
position = [-2, 1, 1]
[[capsule]]
name = "rod"
length = 1
radius = 0.2
position = [2, 2, 1]
[[hull]]
name = "wedge"
points = [[0, 0, 0], [1, 0, 0], [1, 0.5, 0], [0, 0, 1], [1, 0, 1], [1, 0.5, 1]]
position = [-2, 2, -2]
[[body]]
name = "dumb-bell"
shapes = [{ radius = 0.2, position = [-0.5, 0, 0] }, { size = [0.6, 0.1, 0.1], orientation = [0, 0, 30] }]
position = [0, 1, 2]
[[spring]]
between = ["crate", [0, 4, 0]]
stiffness = 1
)";

TEST_F(Export, BodiesAreWhereStatesSaysTheyAre) {
  scene(kThrown);
  const Outcome made = obscura("export scene.toml -o run.glb --fps 20");
  ASSERT_EQ(made.exit, 0) << made.err;
  const Read glb = read_glb(path("run.glb"));
  const Json states = Json::parse(obscura("states scene.toml --at 0,0.35,1").out);
  for (const Json& state : states["states"]) {
    const double t = state["time"];
    for (const Json& body : state["bodies"]) {
      const int node = glb.node(body["name"]);
      ASSERT_GE(node, 0) << body["name"];
      const auto [times, places] = glb.channel(node, "translation");
      const std::size_t key = std::size_t(std::lround(t * 20));
      ASSERT_EQ(times.size(), 21u);
      EXPECT_NEAR(times[key][0], t, 1e-7);  // of numbers up to 1 in single precision
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(places[key][k], body["position"][k], 1e-5) << body["name"] << t;
    }
  }
  // a quaternion, or its opposite
  const auto turns = glb.channel(glb.node("crate"), "rotation").second;
  const Json& last = states["states"][2]["bodies"];
  for (const Json& body : last) {
    if (body["name"] != "crate") continue;
    double dot = 0;
    for (int k = 0; k < 4; ++k) dot += turns[20][k] * double(body["orientation"][k]);
    EXPECT_NEAR(std::abs(dot), 1, 1e-6);
  }
  for (std::size_t k = 1; k < turns.size(); ++k) {
    double dot = 0;
    for (int i = 0; i < 4; ++i) dot += turns[k][i] * turns[k - 1][i];
    EXPECT_GT(dot, 0) << "the long way around";
  }
}

TEST_F(Export, SurfacesLookOutwardsAndHoldTheirVolume) {
  scene(kThrown);
  ASSERT_EQ(obscura("export scene.toml -o run.glb --fps 10").exit, 0);
  const Read glb = read_glb(path("run.glb"));
  const auto volume = [&](const std::string& name) {
    return glb.volume(glb.top["meshes"][int(glb.top["nodes"][glb.node(name)]["mesh"])]);
  };
  const double pi = 3.14159265358979323846;
  EXPECT_NEAR(volume("crate"), 0.6 * 0.4 * 0.5, 1e-6);
  EXPECT_NEAR(volume("wedge"), 0.25, 1e-6);
  // of 32 corners around, a hundredth smaller than what is round
  const double ball = 4 * pi * 0.25 * 0.25 * 0.25 / 3, rod = pi * 0.04 * 0.6 + 4 * pi * 0.008 / 3;
  EXPECT_NEAR(volume("ball") / ball, 0.985, 0.01);
  EXPECT_NEAR(volume("rod") / rod, 0.985, 0.01);
  EXPECT_NEAR(volume("dumb-bell"), 4 * pi * 0.008 / 3 + 0.006, 6e-4);
  EXPECT_GT(volume("spring[0]"), 0);
  for (const Json& mesh : glb.top["meshes"])
    for (const auto& n : glb.rows(mesh["primitives"][0]["attributes"]["NORMAL"]))
      ASSERT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-6) << mesh["name"];
}

TEST_F(Export, APlaneSceneHasDepthAndWhatRestsNoChannel) {
  scene(
      "duration = 0.5\n[room]\nsize = [4, 3]\n[[box]]\nname = \"box\"\nposition = [2, 2]\n[[box]]\nname = "
      "\"shelf\"\n"
      "position = [2, 1]\nsize = [1, 0.1]\nfixed = true\n");
  ASSERT_EQ(obscura("export scene.toml").exit, 0);
  const Read glb = read_glb(path("scene.glb"));
  EXPECT_GT(glb.volume(glb.top["meshes"][0]), 0);
  EXPECT_TRUE(glb.channel(glb.node("shelf"), "translation").second.empty());
  EXPECT_EQ(glb.channel(glb.node("box"), "translation").second.size(), 31u);
  EXPECT_EQ(obscura("export scene.toml -o run.gltf").exit, 2);
}

TEST_F(Export, EndsWhereAnEventStopsTheRun) {
  scene(
      "duration = 2\n[room]\nsize = [4, 3]\n[[ball]]\nname = \"ball\"\nposition = [2, 2]\n[[when]]\n"
      "time = 0.5\ndo = [{ stop = true }]\n");
  ASSERT_EQ(obscura("export scene.toml").exit, 0);
  const Read glb = read_glb(path("scene.glb"));
  EXPECT_EQ(glb.channel(glb.node("ball"), "translation").first.back()[0], 0.5f);
}

}  // namespace
}  // namespace obscura::app
