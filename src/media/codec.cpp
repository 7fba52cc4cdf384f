// The choice of an encoder for a movie, and its settings.
//
// If no preset is asked for, x264 runs `veryfast` without B-frames, look-ahead, macroblock tree and
// weighted prediction. Those spend time to save bytes on camera pictures; ours are flat, with sharp edges,
// and nothing fades. Without the tree, a CRF gives quiet films less than busy ones, next to `medium`: qcomp
// 0.7 levels that in part, and a stronger adaptive quantisation pays for it at the edges. Four seconds of
// 1080p60 at CRF 18, in segments, against x264's `medium`, luma PSNR, bytes, CPU:
//
//   the crowd of the benchmarks: 200 boxes, 500 discs    43.0 against 42.7 dB    1.23    0.29
//   the room of the scenes                               50.0 against 49.2 dB    1.52    0.45
//   its dominoes                                         51.4 against 53.0 dB    1.32    0.41
//
// `superfast` takes 1.7 times the bytes of `medium`, and a fifth less time than this.

#include "media/codec.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>

#include "media/error.h"

namespace obscura::media {

namespace {

using Options = std::vector<std::pair<std::string, std::string>>;

const std::vector<Container>& containers() {
  static const std::vector<std::string> h264 = {"libx264", "libopenh264"};
  static const std::vector<Container> all = {
      {"mp4", "mp4", h264, {"libx265", "libvpx-vp9"}, "H.264"},
      {"mkv", "matroska", h264, {"libx265", "libvpx-vp9"}, "H.264"},
      {"mov", "mov", h264, {"libx265", "prores_ks"}, "H.264"},
      {"webm", "webm", {"libvpx-vp9"}, {}, "VP9"},
      {"gif", "gif", {"gif"}, {}, "GIF"},
      {"y4m", "y4m", {"yuv4mpeg"}, {}, "raw 4:2:0"},
  };
  return all;
}

const std::map<std::string, std::vector<std::string>> kFamilies = {
    {"h264", {"libx264", "libopenh264"}},
    {"hevc", {"libx265"}},
    {"h265", {"libx265"}},
    {"vp9", {"libvpx-vp9"}},
    {"prores", {"prores_ks"}},
};

const std::vector<std::string> kPresets = {"ultrafast", "superfast", "veryfast", "faster",   "fast",
                                           "medium",    "slow",      "slower",   "veryslow", "placebo"};

// those without the macroblock tree; the first is ours
const std::vector<std::string> kTreeless = {"", "ultrafast", "superfast"};

// frames that the slow presets of x264 refer to; the others need at most 3
int references(const std::string& preset) {
  if (preset == "slow") return 5;
  if (preset == "slower") return 8;
  return preset == "veryslow" || preset == "placebo" ? 16 : 3;
}

// Level 4.2 (ITU-T H.264 table A-1), the highest that every player takes: 8,704 macroblocks a frame, 522,240
// a second, 34,816 in the frames referred to. If the picture fits, the number of reference frames is limited
// so that they fit too.
std::string within_level(const MovieSpec& spec) {
  const std::int64_t blocks = std::int64_t((spec.width + 15) / 16) * ((spec.height + 15) / 16);
  if (blocks > 8704 || double(blocks) * double(spec.fps_num) > 522240.0 * double(spec.fps_den)) return "";
  const std::int64_t most = 34816 / blocks;
  return references(spec.preset) > most ? fmt::format(":ref={}", most) : "";
}

double crf_of(const std::string& path, const MovieSpec& spec, double usual, double most) {
  const double crf = spec.crf.value_or(usual);
  if (!(crf >= 1 && crf <= most))
    throw Error(fmt::format("{}: crf is from 1 to {}, got {}", path, most, crf));
  return crf;
}

Options x264(const std::string& path, const MovieSpec& spec) {
  // bytes that depend on frames and settings alone: one thread, no processor's own way of rounding
  std::string parameters = "threads=1:cpu-independent=1:scenecut=0:open-gop=0";
  constexpr const char* kQuick = ":bframes=0:rc-lookahead=0:mbtree=0:weightp=0:qcomp=0.7:aq-strength=1.2";
  parameters += spec.preset.empty() ? kQuick : within_level(spec);
  // A segment is a film of its own: with the macroblock tree, x264 takes its first picture for one that
  // no other refers to. 1.4 times finer, as keyframes in the middle of a film are, quiet films gain 1.4 dB,
  // and have what one encoder of the whole film gives them to 0.2 dB.
  if (std::find(kTreeless.begin(), kTreeless.end(), spec.preset) == kTreeless.end())
    parameters += ":zones=0,0,b=1.4";
  return {{"preset", spec.preset.empty() ? "veryfast" : spec.preset},
          {"profile", "high"},
          {"crf", fmt::format("{}", crf_of(path, spec, 18, 51))},
          {"x264-params", parameters}};
}

Options x265(const std::string& path, const MovieSpec& spec) {
  return {{"preset", spec.preset.empty() ? "fast" : spec.preset},
          {"crf", fmt::format("{}", crf_of(path, spec, 18, 51))},
          {"x265-params", "pools=none:frame-threads=1:scenecut=0:open-gop=0:chromaloc=1:log-level=error"}};
}

}  // namespace

const Container& container(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  if (!ending.empty()) ending.erase(0, 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  for (const Container& one : containers()) {
    if (one.ending == ending) return one;
  }
  throw Error(
      fmt::format("{}: {}: movies end in .mp4 .mkv .mov .webm .gif", path,
                  ending.empty() ? "a movie's name needs an ending" : "no movie format '." + ending + "'"));
}

std::string encoder_name(const std::string& path, const MovieSpec& spec,
                         const std::function<bool(const std::string&)>& present) {
  const Container& kind = container(path);
  const auto first_of = [&](const std::vector<std::string>& names) {
    const auto found = std::find_if(names.begin(), names.end(), present);
    return found == names.end() ? std::string() : *found;
  };
  // gif and raw frames need no library encoder
  if (!spec.alpha && (kind.ending == "gif" || kind.ending == "y4m")) {
    if (spec.codec.empty() || spec.codec == kind.encoders[0]) return kind.encoders[0];
    throw Error(fmt::format("{}: no codec '{}' in a .{} file", path, spec.codec, kind.ending));
  }

  if (spec.alpha) {
    const char* name = kind.ending == "webm" ? "libvpx-vp9" : kind.ending == "mov" ? "prores_ks" : nullptr;
    if (!name)
      throw Error(fmt::format("{}: a .{} has no transparency: .webm (VP9), .mov (ProRes 4444) and .png have",
                              path, kind.ending));
    const auto asked = kFamilies.find(spec.codec);
    const std::string codec = asked != kFamilies.end() ? asked->second.front() : spec.codec;
    if (!codec.empty() && codec != name)
      throw Error(fmt::format("{}: with transparency the codec of a .{} is {}, not {}", path, kind.ending,
                              name, spec.codec));
    if (!present(name)) throw Error(fmt::format("{}: the FFmpeg in use has no {}", path, name));
    return name;
  }
  if (spec.codec.empty()) {
    const std::string name = first_of(kind.encoders);
    if (!name.empty()) return name;
    // the formats that can be written here
    std::string hint = "install an FFmpeg that has one";
    const std::string likely = kind.ending == "webm" ? "a.mp4" : "a.webm";
    const Container& other = container(likely);
    if (!first_of(other.encoders).empty()) {
      hint += fmt::format(", or write {} ({})",
                          std::filesystem::path(path).filename().replace_extension(other.ending).string(),
                          other.video);
    }
    throw Error(fmt::format("{}: the FFmpeg in use has no encoder of {} ({}): {}", path, kind.video,
                            fmt::join(kind.encoders, ", "), hint));
  }

  std::vector<std::string> fitting = kind.encoders;
  fitting.insert(fitting.end(), kind.others.begin(), kind.others.end());
  const auto family = kFamilies.find(spec.codec);
  const std::string name = family != kFamilies.end() ? first_of(family->second) : spec.codec;
  if (present(name) && std::find(fitting.begin(), fitting.end(), name) != fitting.end()) return name;
  std::erase_if(fitting, [&](const std::string& one) { return !present(one); });
  throw Error(fmt::format("{}: no codec '{}' for a .{} file: {}", path, spec.codec, kind.ending,
                          fitting.empty() ? "the FFmpeg in use has none that fits"
                                          : fmt::format("there is {}", fmt::join(fitting, ", "))));
}

Options encoder_options(const std::string& path, const MovieSpec& spec, const std::string& encoder) {
  const bool x26 = encoder == "libx264" || encoder == "libx265";
  if (!spec.preset.empty()) {
    if (!x26)
      throw Error(
          fmt::format("{}: presets are those of libx264 and libx265, and {} has none", path, encoder));
    if (std::find(kPresets.begin(), kPresets.end(), spec.preset) == kPresets.end()) {
      throw Error(
          fmt::format("{}: no preset '{}': they are {}", path, spec.preset, fmt::join(kPresets, " ")));
    }
  }
  if (encoder == "libx264") return x264(path, spec);
  if (encoder == "libx265") return x265(path, spec);
  if (encoder == "libvpx-vp9") {
    // the likeness of "good" at speed 4 in a fifth of its time, for an eighth more bytes
    Options options{{"crf", fmt::format("{}", std::lround(crf_of(path, spec, 24, 63)))},
                    {"deadline", "realtime"},
                    {"cpu-used", "5"},
                    {"row-mt", "0"}};
    // frames that are never shown have no alpha
    if (spec.alpha) options.emplace_back("auto-alt-ref", "0");
    return options;
  }
  if (encoder == "prores_ks") {
    if (spec.crf) throw Error(fmt::format("{}: {} has no crf", path, encoder));
    return {{"profile", "4444"}, {"vendor", "apl0"}};
  }
  // libopenh264 aims at a bit rate, not a quality: an eighth of a bit a pixel is ample for pictures like ours
  if (spec.crf) throw Error(fmt::format("{}: {} has no crf", path, encoder));
  const double rate = double(spec.width) * spec.height * double(spec.fps_num) / double(spec.fps_den) / 8;
  return {{"b", fmt::format("{:.0f}", rate)},
          {"profile", "high"},
          {"rc_mode", "quality"},
          {"allow_skip_frames", "0"}};
}

}  // namespace obscura::media
