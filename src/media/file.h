#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace obscura::media {

/// A file being written under a hidden temporary name beside its final one, so that nothing appears under
/// that name before it is whole. A target that exists and is no regular file (a device, a named pipe) is
/// written in place. Every failure throws media::Error naming the target.
class File {
 public:
  explicit File(const std::string& path);
  /// Removes the temporary file where place() was not reached.
  ~File();
  File(File&&) noexcept;

  void write(std::span<const std::uint8_t> bytes);
  /// Writes out, with `durable` to the disk itself, closes, and renames to the target, or to `instead` beside
  /// it.
  void place(bool durable, const std::string& instead = {});

  int descriptor() const { return descriptor_; }
  /// The temporary name, under which the bytes lie until place().
  const std::string& temporary() const { return temporary_; }

 private:
  std::string path_, target_, temporary_;
  int descriptor_ = -1;
};

/// Makes the folder that a file of this path lies in, and those around it. Throws media::Error naming it.
void make_folder_of(const std::string& path);

/// Removes the temporary files that a killed program left in this folder: those whose final names `ours`
/// accepts. Requires that no other process writes them.
void remove_leftovers(const std::string& folder, const std::function<bool(const std::string& name)>& ours);

/// Writes all of `bytes` to a descriptor, whatever interrupts or shortens it. 0, or errno of the failure.
int write_all(int descriptor, std::span<const std::uint8_t> bytes) noexcept;

}  // namespace obscura::media
