#include "app/run/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "app/console/waiting.h"
#include "media/error.h"
#include "media/png.h"
#include "media/read.h"

namespace obscura::app {

namespace {

namespace fs = std::filesystem;

// frame9.png before frame10.png
bool before(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      const auto number = [&](const std::string& s, std::size_t& k) {
        std::string all;
        for (; k < s.size() && digit(s[k]); ++k)
          if (!all.empty() || s[k] != '0') all += s[k];
        return all;
      };
      const std::string m = number(a, i), n = number(b, j);
      if (m.size() != n.size()) return m.size() < n.size();
      if (m != n) return m < n;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
    }
  }
  return i == a.size() && j < b.size() ? true : i < a.size() && j == b.size() ? false : a < b;
}

bool is_png(const std::string& path) {
  char head[8] = {};
  std::ifstream file(path, std::ios::binary);
  file.read(head, sizeof head);
  return std::memcmp(head, "\x89PNG\r\n\x1a\n", sizeof head) == 0;
}

}  // namespace

struct Frames::Impl {
  std::string path;
  Kind kind = Kind::still;
  std::vector<std::string> names;
  std::optional<media::MovieReader> movie;
  std::int64_t read = 0;
  std::string name;
  std::optional<double> time;
  std::optional<Origin> origin;
};

Frames::Frames(const std::string& path) : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw media::Error(path + ": there is no such file or folder");
  if (fs::is_directory(status)) {
    impl_->kind = Kind::folder;
    std::error_code none;
    const auto links = fs::directory_options::follow_directory_symlink;
    for (fs::recursive_directory_iterator it(path, links, error), end; !error && it != end;
         it.increment(error))
      if (it->path().extension() == ".png" && !it->is_directory(none))
        impl_->names.push_back(it->path().lexically_relative(path).generic_string());
    if (error) throw media::Error(fmt::format("{}: cannot read this folder: {}", path, error.message()));
    if (impl_->names.empty()) throw media::Error(path + ": has no PNG in it");
    std::sort(impl_->names.begin(), impl_->names.end(), before);
  } else if (is_png(path) || fs::path(path).extension() == ".png") {
    impl_->kind = Kind::still;
  } else {
    impl_->kind = Kind::movie;
    impl_->movie.emplace(path);
    impl_->origin = origin_in(impl_->movie->facts().tags);
  }
}

Frames::~Frames() = default;
Frames::Frames(Frames&&) noexcept = default;

Frames::Kind Frames::kind() const { return impl_->kind; }
const std::vector<std::string>& Frames::names() const { return impl_->names; }
void Frames::only(std::vector<std::string> names) { impl_->names = std::move(names); }
std::string Frames::name() const { return impl_->name; }
std::optional<double> Frames::time() const { return impl_->time; }
const std::optional<Origin>& Frames::origin() const { return impl_->origin; }

double Frames::tick() const { return impl_->movie ? impl_->movie->facts().tick : 0; }

bool Frames::next(media::Image& image) {
  Impl& it = *impl_;
  if (it.read > 0) doing("reading frame " + std::to_string(it.read));
  if (it.kind == Kind::movie) {
    if (!it.movie->next(image)) return false;
    it.name = fmt::format("frame {}", it.read++);
    it.time = it.movie->time();
    return true;
  }
  const std::size_t n = it.kind == Kind::still ? 1 : it.names.size();
  if (it.read >= std::int64_t(n)) return false;
  const fs::path file =
      it.kind == Kind::still ? fs::path(it.path) : fs::path(it.path) / it.names[std::size_t(it.read)];
  media::Png png = media::read_png(file.string());
  image = std::move(png.image);
  it.name = it.kind == Kind::still ? file.filename().string() : it.names[std::size_t(it.read)];
  it.origin = origin_in(png.tags);
  it.time.reset();
  if (it.origin) it.time = sim::value(it.origin->shot->time);
  ++it.read;
  return true;
}

std::string file_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw media::Error(path + ": cannot be read");
  std::string bytes;
  char piece[1 << 16];
  while (file.read(piece, sizeof piece) || file.gcount() > 0) bytes.append(piece, std::size_t(file.gcount()));
  if (file.bad()) throw media::Error(path + ": cannot be read");
  return bytes;
}

std::string file_hash(const std::string& path) { return hash(file_bytes(path)); }

}  // namespace obscura::app
