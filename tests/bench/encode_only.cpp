// What encoding alone costs: the frames of a yuv4mpeg file, 4:2:0 already, through libavcodec with the very
// settings of `obscura render`, segments side by side on every core, the packets thrown away.
//
//     encode_only FRAMES.y4m [PRESET]

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "media/encoder.h"
#include "media/error.h"

namespace {

using namespace obscura;

struct Film {
  media::MovieSpec spec;
  std::vector<std::uint8_t*> frames;  // planes one after the other, in the mapped file
};

Film film(const char* path) {
  const int file = open(path, O_RDONLY);
  struct stat status = {};
  if (file < 0 || fstat(file, &status) != 0) throw media::Error(std::string(path) + ": cannot be read");
  auto* bytes = static_cast<std::uint8_t*>(
      mmap(nullptr, std::size_t(status.st_size), PROT_READ, MAP_PRIVATE | MAP_POPULATE, file, 0));
  if (bytes == MAP_FAILED) throw media::Error(std::string(path) + ": cannot be mapped");
  auto* const end = bytes + status.st_size;

  Film film;
  auto* at = static_cast<std::uint8_t*>(std::memchr(bytes, '\n', std::size_t(status.st_size)));
  const std::string header(bytes, at++);
  long long num = 0, den = 0;
  if (std::sscanf(header.c_str(), "YUV4MPEG2 W%d H%d F%lld:%lld", &film.spec.width, &film.spec.height, &num,
                  &den) != 4)
    throw media::Error(std::string(path) + ": not yuv4mpeg: " + header);
  film.spec.fps_num = num;
  film.spec.fps_den = den;
  const std::ptrdiff_t size = std::ptrdiff_t(film.spec.width) * film.spec.height * 3 / 2;
  for (; end - at >= 6 + size; at += 6 + size) film.frames.push_back(at + 6);  // after "FRAME\n"
  return film;
}

// Packets' bytes of the frames [begin, end), as one closed segment.
std::size_t encode(const Film& film, std::size_t begin, std::size_t end) {
  const auto context = media::open_encoder("film.mp4", film.spec);
  const auto packet = media::make_packet();
  std::size_t bytes = 0;
  const auto send = [&](const AVFrame* frame) {
    if (avcodec_send_frame(context.get(), frame) < 0) throw media::Error("the encoder failed");
    while (avcodec_receive_packet(context.get(), packet.get()) >= 0) {
      bytes += std::size_t(packet->size);
      av_packet_unref(packet.get());
    }
  };
  for (std::size_t i = begin; i < end; ++i) {
    const auto frame = media::make_frame();
    frame->format = AV_PIX_FMT_YUV420P;
    frame->width = film.spec.width;
    frame->height = film.spec.height;
    frame->pts = std::int64_t(i - begin);
    const std::size_t luma = std::size_t(frame->width) * std::size_t(frame->height);
    const std::size_t offsets[3] = {0, luma, luma + luma / 4};
    for (int plane = 0; plane < 3; ++plane) {
      frame->data[plane] = film.frames[i] + offsets[plane];
      frame->linesize[plane] = plane == 0 ? frame->width : frame->width / 2;
    }
    frame->buf[0] = av_buffer_create(
        film.frames[i], luma * 3 / 2, [](void*, std::uint8_t*) {}, nullptr, AV_BUFFER_FLAG_READONLY);
    send(frame.get());
  }
  send(nullptr);
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  Film frames = film(argv[1]);
  if (argc > 2) frames.spec.preset = argv[2];
  const auto step = std::size_t(media::segment_frames(frames.spec));

  std::atomic<std::size_t> next = 0, bytes = 0;
  std::vector<std::jthread> workers;
  for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
    workers.emplace_back([&] {
      for (std::size_t begin; (begin = next.fetch_add(step)) < frames.frames.size();)
        bytes += encode(frames, begin, std::min(begin + step, frames.frames.size()));
    });
  workers.clear();
  std::printf("%zu frames, %zu bytes\n", frames.frames.size(), bytes.load());
}
