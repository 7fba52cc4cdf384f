#include "media/mux.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <system_error>

#include "media/codec.h"
#include "media/encoder.h"
#include "media/error.h"
#include "media/libav.h"
#include "media/tags.h"

namespace obscura::media {

namespace {

// QuickTime counts the bytes of a comment in 16 bits: tags that do not fit are left out, the longest first,
// and a remark says so
std::string fitting_comment(Tags tags, const Container& kind) {
  std::string text = comment(tags);
  while (kind.ending == "mov" && text.size() > 65000 && !tags.empty()) {
    const auto longest = std::max_element(tags.begin(), tags.end(), [](const auto& a, const auto& b) {
      return a.second.size() < b.second.size();
    });
    longest->second = "(too long for .mov)";
    text = comment(tags);
  }
  return text;
}

}  // namespace

// libav's own file protocol buffers errors away in places; ours keeps errno, and the descriptor to sync
int Muxer::on_write(void* self, const std::uint8_t* bytes, int size) {
  Muxer& muxer = *static_cast<Muxer*>(self);
  const int code = write_all(muxer.file_.descriptor(), {bytes, std::size_t(size)});
  if (code == 0) return size;
  if (muxer.failure_ == 0) muxer.failure_ = code;
  return AVERROR(code);
}

std::int64_t Muxer::on_seek(void* self, std::int64_t offset, int whence) {
  const int descriptor = static_cast<Muxer*>(self)->file_.descriptor();
  if (whence & AVSEEK_SIZE) return AVERROR(ENOSYS);
  const off_t at = ::lseek(descriptor, offset, whence & ~AVSEEK_FORCE);
  return at < 0 ? AVERROR(errno) : at;
}

void Muxer::require(int code, const char* doing) const {
  if (code >= 0 && format_->pb && format_->pb->error < 0) code = format_->pb->error;
  if (code >= 0 && failure_ == 0) return;
  throw Error(fmt::format("{}: cannot {}: {}", path_, doing,
                          failure_ != 0 ? std::generic_category().message(failure_) : complaint(code)));
}

Muxer::Muxer(const std::string& path, const MovieSpec& spec)
    : path_(path),
      spec_(spec),
      file_(path),
      packet_(make_packet()),
      last_dts_(std::numeric_limits<std::int64_t>::min()) {
  listen();
  const Container& kind = container(path);
  const CodecContext encoder = open_encoder(path, spec);

  AVFormatContext* format = nullptr;
  if (libav().avformat_alloc_output_context2(&format, nullptr, kind.muxer.c_str(), nullptr) < 0)
    throw std::bad_alloc();
  format_.reset(format);
  constexpr int kBuffer = 1 << 16;
  auto* buffer = static_cast<unsigned char*>(libav().av_malloc(kBuffer));
#if LIBAVFORMAT_VERSION_MAJOR >= 61
  format_->pb = libav().avio_alloc_context(buffer, kBuffer, 1, this, nullptr, on_write, on_seek);
#else
  constexpr auto write = [](void* self, std::uint8_t* bytes, int size) {
    return on_write(self, bytes, size);
  };
  format_->pb = libav().avio_alloc_context(buffer, kBuffer, 1, this, nullptr, write, on_seek);
#endif
  // a close that a signal met has closed all the same
  format_->io_close2 = [](AVFormatContext*, AVIOContext* io) {
    const int code = libav().avio_close(io);
    return code == AVERROR(EINTR) ? 0 : code;
  };
  // +faststart reads the file again, by this name
  format_->url = libav().av_strdup(("file:" + file_.temporary()).c_str());
  stream_ = libav().avformat_new_stream(format, nullptr);
  if (!format_->pb || !format_->url || !stream_) throw std::bad_alloc();
  if (::lseek(file_.descriptor(), 0, SEEK_CUR) < 0) format_->pb->seekable = 0;
  // no name of the library's version, no random identities
  format_->flags |= AVFMT_FLAG_CUSTOM_IO | AVFMT_FLAG_BITEXACT;

  if (libav().avcodec_parameters_from_context(stream_->codecpar, encoder.get()) < 0) throw std::bad_alloc();
  stream_->time_base = encoder->time_base;
  stream_->avg_frame_rate = stream_->r_frame_rate = encoder->framerate;
  stream_->sample_aspect_ratio = {1, 1};
  const bool quicktime = kind.muxer == "mp4" || kind.muxer == "mov";
  // Apple's players ask for parameter sets outside the stream
  if (quicktime && encoder->codec_id == AV_CODEC_ID_HEVC)
    stream_->codecpar->codec_tag = MKTAG('h', 'v', 'c', '1');
  // what readers look for
  if (spec.alpha && kind.muxer == "webm") libav().av_dict_set(&stream_->metadata, "alpha_mode", "1", 0);
  if (const auto title = spec.tags.find("Title"); title != spec.tags.end()) {
    libav().av_dict_set(&format_->metadata, "title", title->second.c_str(), 0);
  }
  if (!spec.tags.empty())
    libav().av_dict_set(&format_->metadata, "comment", fitting_comment(spec.tags, kind).c_str(), 0);
}

// the words in the form of the container: plain UTF-8, in mp4 and mov with their length before it
void Muxer::add_text_track(const std::string& muxer) {
  text_ = libav().avformat_new_stream(format_.get(), nullptr);
  if (!text_) throw std::bad_alloc();
  AVCodecParameters& codec = *text_->codecpar;
  codec.codec_type = AVMEDIA_TYPE_SUBTITLE;
  text_->time_base = {1, 1000};
  codec.codec_id = muxer == "webm"       ? AV_CODEC_ID_WEBVTT
                   : muxer == "matroska" ? AV_CODEC_ID_SUBRIP
                                         : AV_CODEC_ID_MOV_TEXT;
  if (codec.codec_id != AV_CODEC_ID_MOV_TEXT) return;
  // 3GPP TS 26.245, TextSampleEntry: centred at the foot, one style, one font
  const std::vector<std::uint8_t> entry = {0,   0,   0,   0,                // display flags
                                           1,   255,                        // horizontally, vertically
                                           0,   0,   0,   0,                // the background's colour
                                           0,   0,   0,   0,   0, 0, 0, 0,  // the box
                                           0,   0,   0,   0,                // the style's characters
                                           0,   1,   0,   18,               // its font, face and size
                                           255, 255, 255, 255,              // its colour
                                           0,   0,   0,   18,               // the table of fonts
                                           'f', 't', 'a', 'b', 0, 1, 0, 1, 5, 'S', 'e', 'r', 'i', 'f'};
  codec.width = spec_.width, codec.height = spec_.height;
  codec.extradata =
      static_cast<std::uint8_t*>(libav().av_mallocz(entry.size() + AV_INPUT_BUFFER_PADDING_SIZE));
  if (!codec.extradata) throw std::bad_alloc();
  std::copy(entry.begin(), entry.end(), codec.extradata);
  codec.extradata_size = int(entry.size());
}

void Muxer::add_chapters() {
  if (spec_.chapters.empty()) return;
  format_->chapters = static_cast<AVChapter**>(libav().av_calloc(spec_.chapters.size(), sizeof(AVChapter*)));
  if (!format_->chapters) throw std::bad_alloc();
  for (const Chapter& each : spec_.chapters) {
    auto* chapter = static_cast<AVChapter*>(libav().av_mallocz(sizeof(AVChapter)));
    if (!chapter) throw std::bad_alloc();
    format_->chapters[format_->nb_chapters++] = chapter;
    chapter->id = format_->nb_chapters;
    chapter->time_base = {1, 1000};
    chapter->start = std::llround(1000 * each.begin), chapter->end = std::llround(1000 * each.end);
    libav().av_dict_set(&chapter->metadata, "title", each.title.c_str(), 0);
  }
}

// the captions that begin at a time (s) or before
void Muxer::write_captions(double until) {
  while (text_ && said_ < spec_.captions.size() && spec_.captions[said_].begin <= until) {
    const TextCue& cue = spec_.captions[said_++];
    const bool counted = text_->codecpar->codec_id == AV_CODEC_ID_MOV_TEXT;
    const std::size_t length = std::min<std::size_t>(cue.text.size(), 65535);
    if (libav().av_new_packet(packet_.get(), int(length + (counted ? 2 : 0))) < 0) throw std::bad_alloc();
    std::uint8_t* to = packet_->data;
    if (counted) *to++ = std::uint8_t(length >> 8), *to++ = std::uint8_t(length & 255);
    std::memcpy(to, cue.text.data(), length);
    const auto ticks = [&](double t) {
      return libav().av_rescale_q(std::llround(1000 * t), {1, 1000}, text_->time_base);
    };
    packet_->stream_index = text_->index;
    packet_->flags = AV_PKT_FLAG_KEY;
    packet_->pts = packet_->dts = ticks(cue.begin);
    packet_->duration = ticks(cue.end) - packet_->pts;
    const int code = libav().av_write_frame(format_.get(), packet_.get());
    libav().av_packet_unref(packet_.get());
    require(code, "write");
  }
}

// the header, with the codec's own as the first segment has it: an encoder's, or that of a file it lay in
void Muxer::begin(const std::vector<std::uint8_t>& extradata) {
  AVCodecParameters& codec = *stream_->codecpar;
  libav().av_freep(&codec.extradata);
  codec.extradata_size = 0;
  if (!extradata.empty()) {
    codec.extradata =
        static_cast<std::uint8_t*>(libav().av_mallocz(extradata.size() + AV_INPUT_BUFFER_PADDING_SIZE));
    if (!codec.extradata) throw std::bad_alloc();
    std::copy(extradata.begin(), extradata.end(), codec.extradata);
    codec.extradata_size = int(extradata.size());
  }
  if (!spec_.captions.empty()) add_text_track(format_->oformat->name);
  add_chapters();
  AVDictionary* options = nullptr;
  const std::string muxer = format_->oformat->name;
  if (muxer == "mp4" || muxer == "mov") libav().av_dict_set(&options, "movflags", "+faststart", 0);
  const int code = libav().avformat_write_header(format_.get(), &options);
  libav().av_dict_free(&options);
  require(code, "begin this movie");
  begun_ = true;
}

void Muxer::Close::operator()(AVFormatContext* format) const {
  if (format->pb) {
    libav().av_freep(&format->pb->buffer);
    libav().avio_context_free(&format->pb);
  }
  libav().avformat_free_context(format);
}

void Muxer::add(const Segment& segment) {
  listen();
  if (!begun_) begin(segment.extradata);
  const AVCodecParameters& codec = *stream_->codecpar;
  if (segment.extradata.size() != std::size_t(codec.extradata_size) ||
      !std::equal(segment.extradata.begin(), segment.extradata.end(), codec.extradata)) {
    throw Error(path_ + ": a segment of other settings than the movie's");
  }
  const AVRational frame{int(spec_.fps_den), int(spec_.fps_num)};
  for (const Segment::Packet& one : segment.packets) {
    write_captions(double(one.pts + frames_) * double(frame.num) / frame.den);
    if (libav().av_new_packet(packet_.get(), int(one.bytes.size())) < 0) throw std::bad_alloc();
    std::memcpy(packet_->data, one.bytes.data(), one.bytes.size());
    if (!one.beside.empty()) {
      std::uint8_t* to = libav().av_packet_new_side_data(packet_.get(), AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL,
                                                         one.beside.size());
      if (!to) throw std::bad_alloc();
      std::memcpy(to, one.beside.data(), one.beside.size());
    }
    packet_->stream_index = stream_->index;
    packet_->flags = one.key ? AV_PKT_FLAG_KEY : 0;
    // frames shown out of the order of decoding have dts before the segment's first pts; every segment's lag
    // the same, so they go on where those of the segment before ended
    const std::int64_t dts = one.dts + frames_;
    if (dts <= last_dts_) throw Error(path_ + ": segments whose packets do not follow each other");
    last_dts_ = dts;
    packet_->pts = libav().av_rescale_q(one.pts + frames_, frame, stream_->time_base);
    packet_->dts = libav().av_rescale_q(dts, frame, stream_->time_base);
    packet_->duration =
        libav().av_rescale_q(one.pts + frames_ + one.duration, frame, stream_->time_base) - packet_->pts;
    const int code = libav().av_write_frame(format_.get(), packet_.get());
    libav().av_packet_unref(packet_.get());
    require(code, "write");
  }
  frames_ += segment.frames;
}

void Muxer::close(const std::string& instead) {
  listen();
  if (!begun_) throw Error(path_ + ": a movie of no frames");
  require(libav().av_write_trailer(format_.get()), "finish");
  libav().avio_flush(format_->pb);
  require(0, "finish");
  file_.place(true, instead);
}

}  // namespace obscura::media
