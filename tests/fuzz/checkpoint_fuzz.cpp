// Any bytes as a checkpoint: it is refused in one line that names the file, or the run goes on for three
// steps to some end.

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "app/run/checkpoint.h"
#include "app/run/frames.h"
#include "app/run/origin.h"
#include "media/error.h"

#include "../fuzz/rooms.h"

namespace obscura {
namespace {

// a file of these bytes, in memory
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& bytes) : descriptor_(::memfd_create("checkpoint", MFD_CLOEXEC)) {
    if (descriptor_ < 0 || ::write(descriptor_, bytes.data(), bytes.size()) != ssize_t(bytes.size()))
      fuzz::fail("no file in memory can be had");
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

// a checkpoint as it is written: its heading up to the hash, and what the hash is of
struct Checkpoint {
  std::string heading, body;
};

const Checkpoint& written(bool space) {
  const auto made = [](bool in_space) {
    namespace fs = std::filesystem;
    const scene::Scene& scene = fuzz::scene_of(in_space);
    const auto run = scene.run();
    run->at({1, 20});
    const fs::path file = fs::temp_directory_path() / ("obscura-fuzz-" + std::to_string(::getpid()));
    app::write_checkpoint(file.string(), scene, *run, false);
    const std::string bytes = app::file_bytes(file.string());
    fs::remove(file);
    const std::size_t line = bytes.find('\n');
    return Checkpoint{bytes.substr(0, line - 32), bytes.substr(line + 1)};
  };
  static const Checkpoint plane = made(false), solid = made(true);
  return space ? solid : plane;
}

}  // namespace
}  // namespace obscura

// The first byte: which scene, and what the others are: the file; what follows a heading with their hash;
// that, laid over a good one, a place of two bytes and then a byte; or the text of the scene it is of.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace obscura;
  if (size < 1) return 0;
  const bool space = bytes[0] & 1;
  const std::string rest(reinterpret_cast<const char*>(bytes + 1), size - 1);
  const Checkpoint& good = written(space);
  const auto headed = [&](const std::string& body) { return good.heading + app::hash(body) + "\n" + body; };
  std::string file;
  switch (bytes[0] >> 1 & 3) {
    case 0:
      file = rest;
      break;
    case 1:
      file = headed(rest);
      break;
    case 2: {
      std::string body = good.body;
      for (std::size_t at = 0; at + 3 <= rest.size(); at += 3)
        body[(std::uint8_t(rest[at]) | std::size_t(std::uint8_t(rest[at + 1])) << 8) % body.size()] =
            rest[at + 2];
      file = headed(body);
      break;
    }
    case 3: {
      auto json = nlohmann::json::from_cbor(good.body);
      json["text"] = rest;
      const auto body = nlohmann::json::to_cbor(json);
      file = headed({body.begin(), body.end()});
      break;
    }
  }
  const MemoryFile memory(file);
  try {
    fuzz::goes_on(*app::run_from(memory.path(), fuzz::scene_of(space)));
  } catch (const media::Error& error) {
    const std::string said = error.what();
    if (said.find('\n') != std::string::npos) fuzz::fail("says two lines: " + said);
    if (!said.starts_with(memory.path())) fuzz::fail("names no file: " + said);
  }
  return 0;
}
