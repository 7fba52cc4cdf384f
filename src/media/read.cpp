#include "media/read.h"

#include <fmt/format.h>

#include <new>

#include "media/error.h"
#include "media/libav.h"
#include "media/tags.h"

namespace obscura::media {

struct MovieReader::Impl {
  std::string path;
  AVFormatContext* format = nullptr;
  AVStream* stream = nullptr;
  CodecContext decoder;
  Packet packet = make_packet();
  Frame frame = make_frame();
  SwsContext* scaler = nullptr;
  MovieFacts facts;
  std::int64_t frames = 0;
  double time = 0;

  explicit Impl(const std::string& p) : path(p) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    libav().sws_freeContext(scaler);
    libav().avformat_close_input(&format);
  }

  [[noreturn]] void fail(int code) const {
    throw Error(fmt::format("{}: not a readable movie: {}", path, complaint(code)));
  }
  void open();
  void feed();
  void convert_to(Image& image);
};

namespace {

std::string text(const AVDictionary* dictionary, const char* key) {
  const AVDictionaryEntry* entry = libav().av_dict_get(dictionary, key, nullptr, 0);
  return entry ? entry->value : "";
}

// A webm keeps alpha as a second stream of VP9 (or VP8), beside the bytes of each packet.
bool has_alpha_beside(const AVStream& stream) { return text(stream.metadata, "alpha_mode") == "1"; }

// FFmpeg's own decoder of VP9 leaves alpha out; libvpx's reads it.
const AVCodec* decoder_of(const AVStream& stream) {
  const AVCodecID codec = stream.codecpar->codec_id;
  if (!has_alpha_beside(stream)) return libav().avcodec_find_decoder(codec);
  return libav().avcodec_find_decoder_by_name(codec == AV_CODEC_ID_VP8 ? "libvpx" : "libvpx-vp9");
}

}  // namespace

void MovieReader::Impl::open() {
  listen();
  int code = libav().avformat_open_input(&format, ("file:" + path).c_str(), nullptr, nullptr);
  if (code < 0) throw Error(fmt::format("{}: cannot read: {}", path, complaint(code)));
  code = libav().avformat_find_stream_info(format, nullptr);
  if (code < 0) fail(code);
  const AVCodec* codec = nullptr;
  code = libav().av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (code < 0) throw Error(path + ": has no moving picture");
  stream = format->streams[code];
  codec = decoder_of(*stream);
  if (!codec)
    throw Error(fmt::format("{}: no decoder of {}{}", path,
                            libav().avcodec_get_name(stream->codecpar->codec_id),
                            has_alpha_beside(*stream) ? " with transparency: it needs libvpx" : ""));

  decoder.reset(libav().avcodec_alloc_context3(codec));
  if (!decoder || libav().avcodec_parameters_to_context(decoder.get(), stream->codecpar) < 0)
    throw std::bad_alloc();
  decoder->err_recognition = AV_EF_EXPLODE;
  decoder->flags |= AV_CODEC_FLAG_BITEXACT;
  code = libav().avcodec_open2(decoder.get(), codec, nullptr);
  if (code < 0) fail(code);

  facts.width = stream->codecpar->width;
  facts.height = stream->codecpar->height;
  const AVRational rate = stream->avg_frame_rate.num > 0 ? stream->avg_frame_rate : stream->r_frame_rate;
  facts.fps_num = rate.num;
  facts.fps_den = rate.den > 0 ? rate.den : 1;
  facts.frames = stream->nb_frames;
  facts.tick = av_q2d(stream->time_base);
  facts.codec = libav().avcodec_get_name(stream->codecpar->codec_id);
  facts.tags = tags_of_comment(text(format->metadata, "comment"));
  const std::string title = text(format->metadata, "title");
  if (!title.empty()) facts.tags["Title"] = title;
}

// hands the decoder its next packet, or the end
void MovieReader::Impl::feed() {
  for (;;) {
    const int code = libav().av_read_frame(format, packet.get());
    if (code == AVERROR_EOF) {
      libav().avcodec_send_packet(decoder.get(), nullptr);
      return;
    }
    if (code < 0) fail(code);
    const bool ours = packet->stream_index == stream->index;
    const int sent = ours ? libav().avcodec_send_packet(decoder.get(), packet.get()) : 0;
    libav().av_packet_unref(packet.get());
    if (sent < 0) fail(sent);
    if (ours) return;
  }
}

void MovieReader::Impl::convert_to(Image& image) {
  if (!scaler) {
    scaler = libav().sws_alloc_context();
    if (!scaler) throw std::bad_alloc();
    const auto set = [&](const char* key, std::int64_t value) {
      libav().av_opt_set_int(scaler, key, value, 0);
    };
    set("srcw", frame->width), set("srch", frame->height), set("src_format", frame->format);
    set("dstw", frame->width), set("dsth", frame->height), set("dst_format", AV_PIX_FMT_RGBA);
    // the same bytes on every processor; chroma where the file says, its centre where it is silent
    set("sws_flags", SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP | SWS_BITEXACT);
    const AVPixFmtDescriptor* shape = libav().av_pix_fmt_desc_get(AVPixelFormat(frame->format));
    if (shape && shape->log2_chroma_w == 1 && shape->log2_chroma_h == 1) {
      set("src_h_chr_pos", frame->chroma_location == AVCHROMA_LOC_LEFT ? 0 : 128);
      set("src_v_chr_pos", 128);
    }
    if (libav().sws_init_context(scaler, nullptr, nullptr) < 0)
      throw Error(path + ": its pixels cannot be made RGB");
    const int matrix = frame->colorspace == AVCOL_SPC_UNSPECIFIED ? SWS_CS_ITU709 : frame->colorspace;
    const int* table = libav().sws_getCoefficients(matrix);
    libav().sws_setColorspaceDetails(scaler, table, frame->color_range == AVCOL_RANGE_JPEG, table, 1, 0,
                                     1 << 16, 1 << 16);
  }
  if (frame->width != facts.width || frame->height != facts.height) {
    throw Error(fmt::format("{}: frame {} has another size than the first", path, frames));
  }
  image.width = frame->width;
  image.height = frame->height;
  image.pixels.resize(std::size_t(4) * frame->width * frame->height);
  std::uint8_t* to[4] = {image.pixels.data()};
  const int stride[4] = {4 * frame->width};
  libav().sws_scale(scaler, frame->data, frame->linesize, 0, frame->height, to, stride);
}

MovieReader::MovieReader(const std::string& path) : impl_(new Impl(path)) { impl_->open(); }
MovieReader::~MovieReader() = default;
MovieReader::MovieReader(MovieReader&&) noexcept = default;

const MovieFacts& MovieReader::facts() const { return impl_->facts; }
double MovieReader::time() const { return impl_->time; }

bool MovieReader::next(Image& image) {
  Impl& m = *impl_;
  listen();
  int code;
  while ((code = libav().avcodec_receive_frame(m.decoder.get(), m.frame.get())) == AVERROR(EAGAIN)) m.feed();
  if (code == AVERROR_EOF) {
    if (m.frames < m.facts.frames) {
      throw Error(fmt::format("{}: ends after {} of {} frames", m.path, m.frames, m.facts.frames));
    }
    return false;
  }
  if (code < 0) m.fail(code);
  if (m.frame->flags & AV_FRAME_FLAG_CORRUPT || m.frame->decode_error_flags != 0) {
    throw Error(fmt::format("{}: frame {} is damaged", m.path, m.frames));
  }
  m.convert_to(image);
  m.time = double(m.frame->best_effort_timestamp) * av_q2d(m.stream->time_base);
  ++m.frames;
  return true;
}

}  // namespace obscura::media
