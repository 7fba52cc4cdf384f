#include "media/libav.h"

#include <dlfcn.h>

#include <cstdarg>
#include <cstring>
#include <mutex>
#include <new>
#include <type_traits>

#include "media/error.h"
#include "media/opened.h"

namespace obscura::media {

namespace {

thread_local char last_line[512] = "";

// runs within C frames: allocates nothing, throws nothing
void on_log(void* context, int level, const char* format, va_list arguments) {
  if (level > AV_LOG_ERROR) return;
  char line[sizeof last_line];
  int prefix = 0;
  libav().av_log_format_line2(context, level, format, arguments, line, sizeof line, &prefix);
  std::size_t length = std::strlen(line);
  while (length > 0 && (line[length - 1] == '\n' || line[length - 1] == ' ')) line[--length] = 0;
  if (length > 0) std::memcpy(last_line, line, length + 1);
}

// of the version that the headers are of
void* library(const char* name) {
  void* found = opened(name);
  if (!found) throw Error(std::string("FFmpeg: ") + name + " cannot be opened");
  return found;
}

Libav load() {
  void* const avutil = library("libavutil.so." AV_STRINGIFY(LIBAVUTIL_VERSION_MAJOR));
  void* const avcodec = library("libavcodec.so." AV_STRINGIFY(LIBAVCODEC_VERSION_MAJOR));
  void* const avformat = library("libavformat.so." AV_STRINGIFY(LIBAVFORMAT_VERSION_MAJOR));
  void* const swscale = library("libswscale.so." AV_STRINGIFY(LIBSWSCALE_VERSION_MAJOR));
  Libav all;
  const auto find = [](auto& function, void* in, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(in, name));
    if (!function) throw Error(std::string("FFmpeg has no ") + name);
  };
#define OBSCURA_FIND(library, function) find(all.function, library, #function);
  OBSCURA_LIBAV_FUNCTIONS(OBSCURA_FIND)
#undef OBSCURA_FIND
  return all;
}

}  // namespace

const Libav& libav() {
  static const Libav all = load();
  return all;
}

Frame make_frame() {
  Frame frame(libav().av_frame_alloc());
  if (!frame) throw std::bad_alloc();
  return frame;
}

Packet make_packet() {
  Packet packet(libav().av_packet_alloc());
  if (!packet) throw std::bad_alloc();
  return packet;
}

void listen() {
  static std::once_flag once;
  std::call_once(once, [] { libav().av_log_set_callback(on_log); });
  last_line[0] = 0;
}

std::string complaint(int code) {
  char meaning[AV_ERROR_MAX_STRING_SIZE] = "";
  libav().av_strerror(code, meaning, sizeof meaning);
  return last_line[0] ? last_line : meaning;
}

std::vector<std::uint8_t> beside(const AVPacket& packet) {
  // libav 5 counts it in size_t, libav 4 in int
  for (int i = 0; i < packet.side_data_elems; ++i) {
    const AVPacketSideData& side = packet.side_data[i];
    if (side.type == AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL) return {side.data, side.data + side.size};
  }
  return {};
}

}  // namespace obscura::media
