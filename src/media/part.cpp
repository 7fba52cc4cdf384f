#include "media/part.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "media/codec.h"
#include "media/error.h"
#include "media/gif.h"
#include "media/libav.h"
#include "media/tags.h"

namespace obscura::media {

namespace {

struct CloseInput {
  void operator()(AVFormatContext* format) const { libav().avformat_close_input(&format); }
};

using Input = std::unique_ptr<AVFormatContext, CloseInput>;

void require(int code, const std::string& path) {
  if (code < 0) throw Error(fmt::format("{}: no part of a movie: {}", path, complaint(code)));
}

Input open(const std::string& path) {
  listen();
  AVFormatContext* opened = nullptr;
  require(libav().avformat_open_input(&opened, ("file:" + path).c_str(), nullptr, nullptr), path);
  return Input(opened);
}

Tags tags_of(const AVFormatContext& format) {
  const AVDictionaryEntry* said = libav().av_dict_get(format.metadata, "comment", nullptr, 0);
  return tags_of_comment(said ? said->value : "");
}

// every packet as it lies in the file: nothing is decoded
Part packets_of(const std::string& path) {
  const Input format = open(path);
  // a whole movie may have a text track and chapters as well
  const int found = libav().av_find_best_stream(format.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (found < 0) throw Error(path + ": no part of a movie");
  const AVStream& stream = *format->streams[found];
  const AVRational frame = av_inv_q(stream.avg_frame_rate);
  if (frame.num <= 0) throw Error(path + ": no part of a movie");

  Part part;
  Segment& segment = part.segment;
  part.tags = tags_of(*format);
  const AVCodecParameters& codec = *stream.codecpar;
  segment.extradata.assign(codec.extradata, codec.extradata + codec.extradata_size);
  const Packet packet = make_packet();
  int code;
  while ((code = libav().av_read_frame(format.get(), packet.get())) >= 0) {
    if (packet->stream_index == found)
      segment.packets.push_back({{packet->data, packet->data + packet->size},
                                 libav().av_rescale_q(packet->pts, stream.time_base, frame),
                                 libav().av_rescale_q(packet->dts, stream.time_base, frame),
                                 1,
                                 (packet->flags & AV_PKT_FLAG_KEY) != 0,
                                 beside(*packet)});
    libav().av_packet_unref(packet.get());
  }
  if (code != AVERROR_EOF) require(code, path);
  segment.frames = int(segment.packets.size());
  // Matroska says how long it is instead, and that at its end
  const std::int64_t said = stream.nb_frames > 0 || format->duration == AV_NOPTS_VALUE
                                ? stream.nb_frames
                                : libav().av_rescale_q(format->duration, {1, AV_TIME_BASE}, frame);
  if (segment.frames == 0 || segment.frames != said) throw Error(path + ": is not whole");
  return part;
}

}  // namespace

std::string part_ending(const std::string& movie, const MovieSpec& spec) {
  const std::string ending = container(movie).ending;
  return spec.alpha || spec.codec.starts_with("prores") || ending == "gif" ? ending : "mp4";
}

void write_part(const std::string& path, const MovieSpec& spec, const Segment& segment) {
  MovieWriter movie(path, spec);
  movie.add(segment);
  movie.close();
}

Part read_part(const std::string& path) {
  if (container(path).ending != "gif") return packets_of(path);
  std::ifstream file(path, std::ios::binary);
  const std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(file)), {});
  return gif_part(path, bytes);
}

Tags part_tags(const std::string& path) {
  return container(path).ending == "gif" ? read_part(path).tags : tags_of(*open(path));
}

}  // namespace obscura::media
