#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "gl/functions.h"

namespace obscura::gl {

/// A buffer that grows and is never given back: one upload a frame, no allocation once warm.
class Buffer {
 public:
  Buffer(const Functions& gl, GLenum target) : gl_(gl), target_(target) { gl.GenBuffers(1, &name_); }
  ~Buffer() { gl_.DeleteBuffers(1, &name_); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  void bind() const { gl_.BindBuffer(target_, name_); }
  GLuint name() const { return name_; }
  /// Binds it and replaces its beginning.
  void upload(const void* bytes, std::size_t size);
  template <class T>
  void upload(const std::vector<T>& items) {
    upload(items.data(), sizeof(T) * items.size());
  }

 private:
  const Functions& gl_;
  GLenum target_;
  GLuint name_ = 0;
  std::size_t capacity_ = 0;
};

/// An attribute: its place in the vertex or instance.
struct Attribute {
  GLint size;
  GLenum type;  // unsigned bytes are normalised
  std::size_t offset;
};

/// Vertices or instances and how the shader reads them, in the order of its locations.
class VertexArray {
 public:
  /// `each`: 1 for attributes that advance by the instance, 0 by the vertex.
  VertexArray(const Functions& gl, std::size_t stride, GLuint each,
              std::initializer_list<Attribute> attributes);
  ~VertexArray() { gl_.DeleteVertexArrays(1, &name_); }
  VertexArray(const VertexArray&) = delete;
  VertexArray& operator=(const VertexArray&) = delete;

  template <class T>
  void upload(const std::vector<T>& items) {
    buffer_.upload(items);
  }
  /// Binds it so that item `first` is the shader's first.
  void bind(int first = 0);

 private:
  const Functions& gl_;
  GLuint name_ = 0;
  Buffer buffer_;
  std::size_t stride_;
  std::vector<Attribute> attributes_;
  int first_ = -1;
};

}  // namespace obscura::gl
