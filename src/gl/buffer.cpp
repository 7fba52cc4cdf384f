#include "gl/buffer.h"

#include <algorithm>

namespace obscura::gl {

void Buffer::upload(const void* bytes, std::size_t size) {
  bind();
  if (size > capacity_) {
    capacity_ = std::max(2 * capacity_, size);
    gl_.BufferData(target_, GLsizeiptr(capacity_), nullptr, GL_STREAM_DRAW);
  }
  gl_.BufferSubData(target_, 0, GLsizeiptr(size), bytes);
}

VertexArray::VertexArray(const Functions& gl, std::size_t stride, GLuint each,
                         std::initializer_list<Attribute> attributes)
    : gl_(gl), buffer_(gl, GL_ARRAY_BUFFER), stride_(stride), attributes_(attributes) {
  gl.GenVertexArrays(1, &name_);
  gl.BindVertexArray(name_);
  for (GLuint i = 0; i < attributes_.size(); ++i) {
    gl.EnableVertexAttribArray(i);
    gl.VertexAttribDivisor(i, each);
  }
}

void VertexArray::bind(int first) {
  gl_.BindVertexArray(name_);
  if (first == first_) return;
  first_ = first;
  buffer_.bind();
  for (GLuint i = 0; i < attributes_.size(); ++i) {
    const Attribute& a = attributes_[i];
    const std::size_t at = std::size_t(first) * stride_ + a.offset;
    gl_.VertexAttribPointer(i, a.size, a.type, a.type == GL_UNSIGNED_BYTE, GLsizei(stride_),
                            reinterpret_cast<const void*>(at));
  }
}

}  // namespace obscura::gl
