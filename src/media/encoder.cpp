#include "media/encoder.h"

#include <fmt/format.h>

#include <limits>
#include <new>

#include "media/codec.h"
#include "media/error.h"
#include "media/libav.h"

namespace obscura::media {

namespace {

// the name of what a picture is cut into, and so what its sides must be even for
std::string words(const AVCodec& codec) {
  switch (codec.id) {
    case AV_CODEC_ID_H264:
      return "H.264";
    case AV_CODEC_ID_HEVC:
      return "HEVC";
    case AV_CODEC_ID_VP9:
      return "VP9";
    case AV_CODEC_ID_PRORES:
      return "ProRes";
    default:
      return codec.name;
  }
}

}  // namespace

void check_frame(const std::string& path, const MovieSpec& spec, const std::string& what) {
  const int width = spec.width, height = spec.height;
  if (width <= 0 || height <= 0)
    throw Error(fmt::format("{}: no movie of {}x{} pixels", path, width, height));
  if (width % 2 != 0 || height % 2 != 0) {
    throw Error(fmt::format("{}: {}x{}: {} 4:2:0 needs even sizes: try {}x{}", path, width, height, what,
                            width + width % 2, height + height % 2));
  }
  // times are counted in 32 bits
  const std::int64_t most = std::numeric_limits<int>::max();
  if (spec.fps_num <= 0 || spec.fps_den <= 0 || spec.fps_num > most || spec.fps_den > most) {
    throw Error(fmt::format("{}: no movie of {}/{} frames a second", path, spec.fps_num, spec.fps_den));
  }
}

CodecContext open_encoder(const std::string& path, const MovieSpec& spec) {
  listen();
  const std::string name = encoder_name(path, spec, [](const std::string& one) {
    return libav().avcodec_find_encoder_by_name(one.c_str()) != nullptr;
  });
  const AVCodec* codec = libav().avcodec_find_encoder_by_name(name.c_str());
  const AVOutputFormat* muxer = libav().av_guess_format(container(path).muxer.c_str(), nullptr, nullptr);
  if (!muxer || libav().avformat_query_codec(muxer, codec->id, FF_COMPLIANCE_NORMAL) != 1) {
    throw Error(
        fmt::format("{}: the FFmpeg in use writes no .{} with {}", path, container(path).ending, name));
  }
  check_frame(path, spec, words(*codec));
  const auto options = encoder_options(path, spec, name);

  CodecContext context(libav().avcodec_alloc_context3(codec));
  if (!context) throw std::bad_alloc();
  context->width = spec.width;
  context->height = spec.height;
  context->sample_aspect_ratio = {1, 1};
  context->pix_fmt = codec->id == AV_CODEC_ID_PRORES ? AV_PIX_FMT_YUVA444P10
                     : spec.alpha                    ? AV_PIX_FMT_YUVA420P
                                                     : AV_PIX_FMT_YUV420P;
  context->time_base = {int(spec.fps_den), int(spec.fps_num)};
  context->framerate = {int(spec.fps_num), int(spec.fps_den)};
  // bt709 in all three, which is what players assume of such sizes: the sRGB transfer would be the truer
  // word, and makes some of them shift the colours
  context->color_primaries = AVCOL_PRI_BT709;
  context->color_trc = AVCOL_TRC_BT709;
  context->colorspace = AVCOL_SPC_BT709;
  context->color_range = AVCOL_RANGE_MPEG;
  context->chroma_sample_location = AVCHROMA_LOC_CENTER;
  context->bit_rate = 0;
  context->thread_count = 1;
  context->gop_size = segment_frames(spec);
  context->flags |= AV_CODEC_FLAG_CLOSED_GOP | AV_CODEC_FLAG_BITEXACT;
  if (muxer->flags & AVFMT_GLOBALHEADER) context->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;

  AVDictionary* dictionary = nullptr;
  for (const auto& [key, value] : options) libav().av_dict_set(&dictionary, key.c_str(), value.c_str(), 0);
  const int code = libav().avcodec_open2(context.get(), codec, &dictionary);
  const AVDictionaryEntry* unknown = libav().av_dict_get(dictionary, "", nullptr, AV_DICT_IGNORE_SUFFIX);
  const std::string left = unknown ? unknown->key : "";
  libav().av_dict_free(&dictionary);
  if (code < 0) throw Error(fmt::format("{}: {} cannot be started: {}", path, name, complaint(code)));
  if (!left.empty()) throw Error(fmt::format("{}: this {} has no option '{}'", path, name, left));
  return context;
}

}  // namespace obscura::media
