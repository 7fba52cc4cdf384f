#include "media/libav.h"

#include <cstdarg>
#include <cstring>
#include <mutex>
#include <new>

extern "C" {
#include <libavutil/log.h>
}

namespace obscura::media {

namespace {

thread_local char last_line[512] = "";

// runs within C frames: allocates nothing, throws nothing
void on_log(void* context, int level, const char* format, va_list arguments) {
  if (level > AV_LOG_ERROR) return;
  char line[sizeof last_line];
  int prefix = 0;
  av_log_format_line2(context, level, format, arguments, line, sizeof line, &prefix);
  std::size_t length = std::strlen(line);
  while (length > 0 && (line[length - 1] == '\n' || line[length - 1] == ' ')) line[--length] = 0;
  if (length > 0) std::memcpy(last_line, line, length + 1);
}

}  // namespace

Frame make_frame() {
  Frame frame(av_frame_alloc());
  if (!frame) throw std::bad_alloc();
  return frame;
}

Packet make_packet() {
  Packet packet(av_packet_alloc());
  if (!packet) throw std::bad_alloc();
  return packet;
}

void listen() {
  static std::once_flag once;
  std::call_once(once, [] { av_log_set_callback(on_log); });
  last_line[0] = 0;
}

std::string complaint(int code) {
  char meaning[AV_ERROR_MAX_STRING_SIZE] = "";
  av_strerror(code, meaning, sizeof meaning);
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
