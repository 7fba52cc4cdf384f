#include <fmt/format.h>

#include <cassert>
#include <new>
#include <utility>
#include <variant>

#include "media/alpha.h"
#include "media/codec.h"
#include "media/encoder.h"
#include "media/error.h"
#include "media/gif.h"
#include "media/movie.h"

namespace obscura::media {

// a segment by one of libav's encoders
class LibavEncoder {
 public:
  LibavEncoder(const std::string& path, const MovieSpec& spec)
      : path_(path), context_(open_encoder(path, spec)), frame_(make_frame()), packet_(make_packet()) {
    frame_->format = context_->pix_fmt;
    frame_->width = spec.width;
    frame_->height = spec.height;
    frame_->color_primaries = context_->color_primaries;
    frame_->color_trc = context_->color_trc;
    frame_->colorspace = context_->colorspace;
    frame_->color_range = context_->color_range;
    frame_->chroma_location = context_->chroma_sample_location;
    if (libav().av_frame_get_buffer(frame_.get(), 0) < 0) throw std::bad_alloc();
    segment_.extradata.assign(context_->extradata, context_->extradata + context_->extradata_size);
  }

  void add(const Image& image, const std::vector<Rect>* changed) {
    assert(image.width == frame_->width && image.height == frame_->height);
    listen();
    // the encoder may still hold the planes of the frame before
    if (libav().av_frame_make_writable(frame_.get()) < 0) throw std::bad_alloc();
    fill(image, segment_.frames > 0 ? changed : nullptr);
    frame_->pts = segment_.frames++;
    send(frame_.get());
  }

  Segment finish() {
    listen();
    if (segment_.frames > 0) send(nullptr);
    if (int(segment_.packets.size()) != segment_.frames) {
      throw Error(fmt::format("{}: {} made {} packets of {} frames", path_, context_->codec->name,
                              segment_.packets.size(), segment_.frames));
    }
    return std::move(segment_);
  }

 private:
  // the frame's planes, which have the frame before
  void fill(const Image& image, const std::vector<Rect>* changed) {
    const auto deep = [&](int k) { return reinterpret_cast<std::uint16_t*>(frame_->data[k]); };
    const auto stride = [&](int k) { return frame_->linesize[k] / 2; };
    const Yuv420 planes{frame_->data[0],     frame_->data[1],     frame_->data[2],
                        frame_->linesize[0], frame_->linesize[1], frame_->linesize[2]};
    switch (context_->pix_fmt) {
      case AV_PIX_FMT_YUVA444P10:
        return convert_deep(image,
                            {deep(0), deep(1), deep(2), deep(3), stride(0), stride(1), stride(2), stride(3)});
      case AV_PIX_FMT_YUVA420P: {
        Image spread = image;
        spread_colors(spread);
        convert(spread, planes);
        return alpha_plane(image, frame_->data[3], frame_->linesize[3]);
      }
      default:
        if (!changed) return convert(image, planes);
        for (const Rect& rect : *changed) convert(image, planes, rect);
    }
  }

  // hands over a frame, or the end, and takes what packets come back
  void send(const AVFrame* frame) {
    int code = libav().avcodec_send_frame(context_.get(), frame);
    if (code < 0) fail(code);
    while ((code = libav().avcodec_receive_packet(context_.get(), packet_.get())) >= 0) {
      const AVPacket& p = *packet_;
      segment_.packets.push_back(
          {{p.data, p.data + p.size}, p.pts, p.dts, 1, (p.flags & AV_PKT_FLAG_KEY) != 0, beside(p)});
      libav().av_packet_unref(packet_.get());
    }
    if (code != AVERROR(EAGAIN) && code != AVERROR_EOF) fail(code);
  }

  [[noreturn]] void fail(int code) const {
    throw Error(fmt::format("{}: {} failed: {}", path_, context_->codec->name, complaint(code)));
  }

  std::string path_;
  CodecContext context_;
  Frame frame_;
  Packet packet_;
  Segment segment_;
};

struct SegmentEncoder::Impl {
  template <typename Encoder>
  Impl(std::in_place_type_t<Encoder> type, const std::string& path, const MovieSpec& spec)
      : encoder(type, path, spec) {}
  std::variant<LibavEncoder, GifEncoder> encoder;
};

SegmentEncoder::SegmentEncoder(const std::string& path, const MovieSpec& spec)
    : impl_(container(path).ending == "gif" ? new Impl(std::in_place_type<GifEncoder>, path, spec)
                                            : new Impl(std::in_place_type<LibavEncoder>, path, spec)) {}

SegmentEncoder::~SegmentEncoder() = default;
SegmentEncoder::SegmentEncoder(SegmentEncoder&&) noexcept = default;

void SegmentEncoder::add(const Image& frame, const std::vector<Rect>* changed) {
  if (auto* libav = std::get_if<LibavEncoder>(&impl_->encoder))
    libav->add(frame, changed);
  else
    std::get<GifEncoder>(impl_->encoder).add(frame);
}

Segment SegmentEncoder::finish() {
  return std::visit([](auto& encoder) { return encoder.finish(); }, impl_->encoder);
}

}  // namespace obscura::media
