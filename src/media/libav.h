#pragma once

// FFmpeg's C libraries, as this room uses them: owners of their handles, their error codes and log lines as
// words.

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/frame.h>
}

#include <memory>
#include <string>
#include <vector>

namespace obscura::media {

struct FreeLibav {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
using CodecContext = std::unique_ptr<AVCodecContext, FreeLibav>;
using Frame = std::unique_ptr<AVFrame, FreeLibav>;
using Packet = std::unique_ptr<AVPacket, FreeLibav>;

Frame make_frame();
Packet make_packet();

/// What a packet of VP9 has beside its bytes: its alpha; empty: none.
std::vector<std::uint8_t> beside(const AVPacket& packet);

/// Keeps libav from writing to stderr, and begins to record: `complaint` tells the errors that it logs in
/// this thread from here on.
void listen();

/// The message for a libav call that returned `code`: the last line it logged as an error in this thread, or
/// else the meaning of the code.
std::string complaint(int code);

}  // namespace obscura::media
