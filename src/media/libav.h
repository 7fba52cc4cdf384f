#pragma once

// FFmpeg's C libraries, as this room uses them: their functions, owners of their handles, their error codes
// and log lines as words. The libraries and what they need are a hundred, and are opened when the first
// function is asked for: to load them takes as long as to draw a still.

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/dict.h>
#include <libavutil/frame.h>
#include <libavutil/log.h>
#include <libavutil/mathematics.h>
#include <libavutil/mem.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <memory>
#include <string>
#include <vector>

namespace obscura::media {

// F(library, function)
#define OBSCURA_LIBAV_FUNCTIONS(F)            \
  F(avutil, av_calloc)                        \
  F(avutil, av_dict_free)                     \
  F(avutil, av_dict_get)                      \
  F(avutil, av_dict_set)                      \
  F(avutil, av_frame_alloc)                   \
  F(avutil, av_frame_free)                    \
  F(avutil, av_frame_get_buffer)              \
  F(avutil, av_frame_make_writable)           \
  F(avutil, av_freep)                         \
  F(avutil, av_log_format_line2)              \
  F(avutil, av_log_set_callback)              \
  F(avutil, av_malloc)                        \
  F(avutil, av_mallocz)                       \
  F(avutil, av_opt_set_int)                   \
  F(avutil, av_pix_fmt_desc_get)              \
  F(avutil, av_rescale_q)                     \
  F(avutil, av_strdup)                        \
  F(avutil, av_strerror)                      \
  F(avcodec, av_new_packet)                   \
  F(avcodec, av_packet_alloc)                 \
  F(avcodec, av_packet_free)                  \
  F(avcodec, av_packet_new_side_data)         \
  F(avcodec, av_packet_unref)                 \
  F(avcodec, avcodec_alloc_context3)          \
  F(avcodec, avcodec_find_decoder)            \
  F(avcodec, avcodec_find_decoder_by_name)    \
  F(avcodec, avcodec_find_encoder_by_name)    \
  F(avcodec, avcodec_free_context)            \
  F(avcodec, avcodec_get_name)                \
  F(avcodec, avcodec_license)                 \
  F(avcodec, avcodec_open2)                   \
  F(avcodec, avcodec_parameters_from_context) \
  F(avcodec, avcodec_parameters_to_context)   \
  F(avcodec, avcodec_receive_frame)           \
  F(avcodec, avcodec_receive_packet)          \
  F(avcodec, avcodec_send_frame)              \
  F(avcodec, avcodec_send_packet)             \
  F(avcodec, avcodec_version)                 \
  F(avformat, av_find_best_stream)            \
  F(avformat, av_guess_format)                \
  F(avformat, av_read_frame)                  \
  F(avformat, av_write_frame)                 \
  F(avformat, av_write_trailer)               \
  F(avformat, avformat_alloc_output_context2) \
  F(avformat, avformat_close_input)           \
  F(avformat, avformat_find_stream_info)      \
  F(avformat, avformat_free_context)          \
  F(avformat, avformat_new_stream)            \
  F(avformat, avformat_open_input)            \
  F(avformat, avformat_query_codec)           \
  F(avformat, avformat_write_header)          \
  F(avformat, avio_alloc_context)             \
  F(avformat, avio_close)                     \
  F(avformat, avio_context_free)              \
  F(avformat, avio_flush)                     \
  F(swscale, sws_alloc_context)               \
  F(swscale, sws_freeContext)                 \
  F(swscale, sws_getCoefficients)             \
  F(swscale, sws_init_context)                \
  F(swscale, sws_scale)                       \
  F(swscale, sws_setColorspaceDetails)

struct Libav {
#define OBSCURA_POINTER(library, function) decltype(&::function) function = nullptr;
  OBSCURA_LIBAV_FUNCTIONS(OBSCURA_POINTER)
#undef OBSCURA_POINTER
};

/// The functions. Opens the libraries when it is first called; throws Error where one of them is missing, and
/// std::bad_alloc where there is no memory for them.
const Libav& libav();

struct FreeLibav {
  void operator()(AVCodecContext* context) const { libav().avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { libav().av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { libav().av_packet_free(&packet); }
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
