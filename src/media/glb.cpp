// glTF 2.0, binary: a header, the scene as JSON, and one buffer with all numbers (Khronos, glTF 2.0 §4.4).
//   "glTF" 2 length | length "JSON" text, spaces to fours | length "BIN\0" numbers, zeros to fours

#include "media/glb.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "media/error.h"
#include "media/file.h"

namespace obscura::media {

namespace {

static_assert(std::endian::native == std::endian::little);

using Json = nlohmann::ordered_json;

constexpr int kFloat = 5126, kUnsigned = 5125;                 // component types
constexpr int kVertices = 34962, kIndices = 34963, kNone = 0;  // what a view is for

// the one buffer, and the JSON that says what lies where in it
class Buffer {
 public:
  // numbers as an accessor; its index
  template <class T>
  int add(const std::vector<T>& items, const char* type, int component, int target, bool bounds) {
    const std::size_t from = bytes_.size(), size = items.size() * sizeof(T);
    bytes_.resize(from + size);
    std::memcpy(bytes_.data() + from, items.data(), size);
    Json view = {{"buffer", 0}, {"byteOffset", from}, {"byteLength", size}};
    if (target != kNone) view["target"] = target;
    views.push_back(std::move(view));
    Json accessor = {{"bufferView", views.size() - 1},
                     {"componentType", component},
                     {"count", items.size()},
                     {"type", type}};
    if (bounds) {
      constexpr std::size_t n = sizeof(T) / sizeof(float);
      std::array<float, n> low, high;
      low.fill(std::numeric_limits<float>::max()), high.fill(std::numeric_limits<float>::lowest());
      for (const T& item : items) {
        std::array<float, n> each;
        std::memcpy(each.data(), &item, sizeof item);
        for (std::size_t k = 0; k < n; ++k)
          low[k] = std::min(low[k], each[k]), high[k] = std::max(high[k], each[k]);
      }
      accessor["min"] = low, accessor["max"] = high;
    }
    accessors.push_back(std::move(accessor));
    return int(accessors.size()) - 1;
  }

  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

  Json views = Json::array(), accessors = Json::array();

 private:
  std::vector<std::uint8_t> bytes_;
};

void put(std::vector<std::uint8_t>& out, std::uint32_t word) {
  for (int k = 0; k < 4; ++k) out.push_back(std::uint8_t(word >> 8 * k));
}

void put_chunk(std::vector<std::uint8_t>& out, std::uint32_t type, const void* data, std::size_t size,
               std::uint8_t filler) {
  const std::size_t whole = (size + 3) / 4 * 4;
  put(out, std::uint32_t(whole)), put(out, type);
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  out.insert(out.end(), bytes, bytes + size);
  out.insert(out.end(), whole - size, filler);
}

}  // namespace

void write_glb(const std::string& path, const Glb& scene) {
  Buffer buffer;
  Json meshes = Json::array(), materials = Json::array(), nodes = Json::array();
  for (const Glb::Mesh& mesh : scene.meshes) {
    const Json attributes = {{"POSITION", buffer.add(mesh.positions, "VEC3", kFloat, kVertices, true)},
                             {"NORMAL", buffer.add(mesh.normals, "VEC3", kFloat, kVertices, false)}};
    const int triangles = buffer.add(mesh.triangles, "SCALAR", kUnsigned, kIndices, false);
    const Json material = {
        {"pbrMetallicRoughness",
         {{"baseColorFactor", mesh.color}, {"metallicFactor", 0}, {"roughnessFactor", 0.6}}}};
    std::size_t same = 0;
    while (same < materials.size() && materials[same] != material) ++same;
    if (same == materials.size()) materials.push_back(material);
    meshes.push_back(
        {{"name", mesh.name},
         {"primitives", {{{"attributes", attributes}, {"indices", triangles}, {"material", same}}}}});
  }

  // a node stands as at the beginning; a property that changes has a channel
  Json samplers = Json::array(), channels = Json::array(), roots = Json::array();
  int times = -1;
  const auto animate = [&](const auto& values, const char* type, const char* target) {
    if (values.size() < 2) return;
    if (times < 0) times = buffer.add(scene.times, "SCALAR", kFloat, kNone, true);
    samplers.push_back({{"input", times},
                        {"output", buffer.add(values, type, kFloat, kNone, false)},
                        {"interpolation", "LINEAR"}});
    channels.push_back(
        {{"sampler", samplers.size() - 1}, {"target", {{"node", nodes.size()}, {"path", target}}}});
  };
  for (const Glb::Node& node : scene.nodes) {
    Json it = {{"name", node.name}};
    if (node.mesh >= 0) it["mesh"] = node.mesh;
    if (!node.translations.empty()) it["translation"] = node.translations.front();
    if (!node.rotations.empty()) it["rotation"] = node.rotations.front();
    if (!node.scales.empty()) it["scale"] = node.scales.front();
    animate(node.translations, "VEC3", "translation");
    animate(node.rotations, "VEC4", "rotation");
    animate(node.scales, "VEC3", "scale");
    roots.push_back(nodes.size());
    nodes.push_back(std::move(it));
  }

  Json top = {{"asset", {{"version", "2.0"}, {"generator", scene.generator}}},
              {"scene", 0},
              {"scenes", {{{"name", scene.name}, {"nodes", roots}}}},
              {"nodes", nodes},
              {"meshes", meshes},
              {"materials", materials},
              {"accessors", buffer.accessors},
              {"bufferViews", buffer.views},
              {"buffers", {{{"byteLength", (buffer.bytes().size() + 3) / 4 * 4}}}}};
  if (!channels.empty())
    top["animations"] = {{{"name", "run"}, {"samplers", samplers}, {"channels", channels}}};
  const std::string text = top.dump();

  std::vector<std::uint8_t> out;
  const std::size_t length = 12 + 8 + (text.size() + 3) / 4 * 4 + 8 + (buffer.bytes().size() + 3) / 4 * 4;
  if (length > std::numeric_limits<std::uint32_t>::max())
    throw Error(fmt::format("{}: {} bytes are more than a glTF binary holds; fewer frames or a shorter run",
                            path, length));
  put(out, 0x46546C67), put(out, 2), put(out, std::uint32_t(length));
  put_chunk(out, 0x4E4F534A, text.data(), text.size(), ' ');
  put_chunk(out, 0x004E4942, buffer.bytes().data(), buffer.bytes().size(), 0);
  File file(path);
  file.write(out);
  file.place(false);
}

}  // namespace obscura::media
