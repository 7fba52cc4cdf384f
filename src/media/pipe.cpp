#include "media/pipe.h"

#include <fmt/format.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "media/encoder.h"
#include "media/error.h"
#include "media/file.h"
#include "media/yuv.h"

namespace obscura::media {

PipeFrames::PipeFrames(PipeFormat format, const MovieSpec& spec)
    : format_(format), width_(spec.width), height_(spec.height) {
  if (format == PipeFormat::y4m) check_frame("y4m", spec, "y4m");
}

void PipeFrames::make(const Image& frame, const std::vector<Rect>* changed,
                      std::vector<std::uint8_t>& bytes) {
  if (format_ == PipeFormat::rgba) {
    bytes = frame.pixels;
    return;
  }
  const std::size_t luma = std::size_t(width_) * std::size_t(height_);
  if (planes_.empty()) changed = nullptr;
  planes_.resize(luma * 3 / 2);
  std::uint8_t* const y = planes_.data();
  const Yuv420 planes{y, y + luma, y + luma * 5 / 4, width_, width_ / 2, width_ / 2};
  if (!changed) {
    convert(frame, planes);
  } else {
    for (const Rect& rect : *changed) convert(frame, planes, rect);
  }
  bytes = planes_;
}

PipeWriter::PipeWriter(int descriptor, PipeFormat format, const MovieSpec& spec)
    : descriptor_(descriptor), format_(format), spec_(spec) {
  if (format == PipeFormat::y4m) check_frame("y4m", spec, "y4m");
}

bool PipeWriter::write(std::span<const std::uint8_t> frame) {
  int code = 0;
  if (format_ == PipeFormat::y4m) {
    // "420jpeg" is y4m's word for chroma sited at the centre of its four pixels, whatever the range
    std::string head;
    if (!begun_) {
      head = fmt::format("YUV4MPEG2 W{} H{} F{}:{} Ip A1:1 C420jpeg XYSCSS=420JPEG XCOLORRANGE=LIMITED\n",
                         spec_.width, spec_.height, spec_.fps_num, spec_.fps_den);
    }
    head += "FRAME\n";
    const auto* const begin = reinterpret_cast<const std::uint8_t*>(head.data());
    code = write_all(descriptor_, std::span(begin, head.size()));
  }
  begun_ = true;
  if (code == 0) code = write_all(descriptor_, frame);
  if (code == EPIPE) return false;
  if (code != 0) throw Error("the pipe: cannot write: " + std::generic_category().message(code));
  return true;
}

}  // namespace obscura::media
