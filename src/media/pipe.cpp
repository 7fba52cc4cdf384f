#include "media/pipe.h"

#include <fmt/format.h>

#include <cerrno>
#include <span>
#include <system_error>

#include "media/encoder.h"
#include "media/error.h"
#include "media/file.h"

namespace obscura::media {

PipeWriter::PipeWriter(int descriptor, PipeFormat format, const MovieSpec& spec)
    : descriptor_(descriptor), format_(format), spec_(spec) {
  if (format == PipeFormat::y4m) check_frame("y4m", spec, "y4m");
}

bool PipeWriter::write(const Image& frame) {
  std::span<const std::uint8_t> bytes = frame.pixels;
  if (format_ == PipeFormat::y4m) {
    const std::size_t luma = std::size_t(spec_.width) * spec_.height;
    // "420jpeg" is y4m's word for chroma sited at the centre of its four pixels, whatever the range
    std::string head;
    if (!begun_) {
      head = fmt::format("YUV4MPEG2 W{} H{} F{}:{} Ip A1:1 C420jpeg XYSCSS=420JPEG XCOLORRANGE=LIMITED\n",
                         spec_.width, spec_.height, spec_.fps_num, spec_.fps_den);
    }
    head += "FRAME\n";
    planes_.resize(head.size() + luma * 3 / 2);
    std::copy(head.begin(), head.end(), planes_.begin());
    std::uint8_t* y = planes_.data() + head.size();
    const int half = spec_.width / 2;
    convert(frame, {y, y + luma, y + luma * 5 / 4, spec_.width, half, half});
    bytes = planes_;
  }
  begun_ = true;
  const int code = write_all(descriptor_, bytes);
  if (code == EPIPE) return false;
  if (code != 0) throw Error("the pipe: cannot write: " + std::generic_category().message(code));
  return true;
}

}  // namespace obscura::media
