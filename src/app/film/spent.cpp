#include "app/film/spent.h"

#include <fcntl.h>
#include <unistd.h>

#include <charconv>
#include <fstream>
#include <utility>

#include <fmt/format.h>

namespace obscura::app {

Spent::Spent(std::string path) : path_(std::move(path)) {
  std::ifstream in(path_);
  std::string word;
  if (!(in >> word)) return;
  double seconds = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), seconds);
  if (error == std::errc() && end == word.data() + word.size() && seconds >= 0) before_ = seconds;
}

Spent::~Spent() {
  if (counting_) write();
}

void Spent::begin(double before) {
  before_ = before, counting_ = true, began_ = Clock::now();
  write();
}

void Spent::note() {
  if (counting_ && Clock::now() - written_ >= std::chrono::seconds(1)) write();
}

void Spent::remove() {
  counting_ = false;
  ::unlink(path_.c_str());
}

// in one piece, and always as long: no other process finds half of it
void Spent::write() {
  written_ = Clock::now();
  const std::string line =
      fmt::format("{:14.3f}\n", *before_ + std::chrono::duration<double>(written_ - began_).count());
  const int file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) return;
  (void)!::pwrite(file, line.data(), line.size(), 0);
  ::close(file);
}

}  // namespace obscura::app
