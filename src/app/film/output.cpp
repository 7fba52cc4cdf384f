#include "app/film/output.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "app/console/exit.h"
#include "media/codec.h"
#include "media/error.h"

namespace obscura::app {

namespace {

// the place and width of the frame number in a name
struct Pattern {
  std::size_t begin = 0, end = 0;
  int width = 0;
};

std::optional<Pattern> pattern(const std::string& path) {
  const std::size_t brace = path.find("{frame");
  if (brace != std::string::npos) {
    const std::size_t close = path.find('}', brace);
    if (close == std::string::npos)
      throw UsageError(fmt::format("{}: the pattern {{frame has no closing brace", path));
    const std::string spec = path.substr(brace + 6, close - brace - 6);
    const bool plain = spec.empty();
    const bool wide = spec.size() >= 2 && spec.size() <= 4 && spec[0] == ':' &&
                      std::all_of(spec.begin() + 1, spec.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!plain && !wide) throw UsageError(fmt::format("{}: expected {{frame}} or {{frame:04}}", path));
    return Pattern{brace, close + 1, plain ? 0 : std::stoi(spec.substr(1))};
  }
  const std::size_t percent = path.find('%');
  if (percent == std::string::npos) return {};
  std::size_t end = percent + 1;
  while (end < path.size() && path[end] >= '0' && path[end] <= '9') ++end;
  if (end >= path.size() || path[end] != 'd' || end - percent > 4) {
    throw UsageError(fmt::format("{}: expected %d or %04d", path));
  }
  return Pattern{percent, end + 1,
                 end == percent + 1 ? 0 : std::stoi(path.substr(percent + 1, end - percent - 1))};
}

std::string lower_ending(const std::string& path) {
  std::string e = std::filesystem::path(path).extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return e;
}

}  // namespace

std::string Output::file(std::int64_t n) const {
  const auto p = plain ? std::nullopt : pattern(path);
  if (!p) return path;
  return path.substr(0, p->begin) + fmt::format("{:0{}}", n, std::max(1, p->width)) + path.substr(p->end);
}

std::string Output::partial() const {
  const std::filesystem::path p(path);
  return (p.parent_path() / (p.stem().string() + ".partial" + p.extension().string())).string();
}

namespace {

std::string beside(const Output& output, const char* ending) {
  const std::string& path = output.path;
  const auto p = output.plain ? std::nullopt : pattern(path);
  return (p ? path.substr(0, p->begin) + "frame" + path.substr(p->end) : path) + ending;
}

}  // namespace

std::string Output::parts() const { return beside(*this, ".parts"); }
std::string Output::checkpoints() const { return beside(*this, ".checkpoints"); }

void require_fresh(const std::string& file) {
  if (std::filesystem::exists(file))
    throw media::Error(fmt::format("{}: is there already, and --no-overwrite was asked for", file));
}

Output output(const std::optional<std::string>& out, const std::string& name, bool still,
              std::int64_t frames) {
  if (!out) {
    return {still ? Output::Form::still : Output::Form::movie,
            fmt::format("render_out/{}.{}", name, still ? "png" : "mp4"), true};
  }
  std::string path = *out;
  if (path == "-") return {Output::Form::pipe, path};
  if (path.empty()) throw UsageError("-o needs a name");
  std::error_code none;
  if (path.back() == '/' || (lower_ending(path).empty() && std::filesystem::is_directory(path, none))) {
    if (path.back() != '/') path += '/';
    path += still ? name + ".png" : "{frame:04}.png";
  }
  const auto p = pattern(path);
  std::string rest = path;
  if (p) rest.erase(p->begin, p->end - p->begin);
  if (const auto camera = rest.find("{camera}"); camera != std::string::npos) rest.erase(camera, 8);
  if (const auto open = rest.find('{'), close = rest.find('}', open); close != std::string::npos)
    throw UsageError(
        fmt::format("{}: {} is not known; a name may have {{camera}}, and that of a sequence "
                    "{{frame:04}}, once",
                    path, rest.substr(open, close + 1 - open)));
  if (lower_ending(path) == ".png") {
    if (p && !still) return {Output::Form::frames, path};
    if (still || frames == 1) return {Output::Form::still, path};
    throw UsageError(
        fmt::format("{}: {} frames need a number in the name, as in {}; for one still, --at SECONDS", path,
                    frames, (std::filesystem::path(path).replace_extension().string() + "/{frame:04}.png")));
  }
  if (p) throw UsageError(fmt::format("{}: a sequence of pictures ends in .png", path));
  if (still) throw UsageError(fmt::format("{}: a still (--at) ends in .png", path));
  try {
    (void)media::container(path);
  } catch (const media::Error& error) {
    throw UsageError(error.what());
  }
  return {Output::Form::movie, path};
}

}  // namespace obscura::app
