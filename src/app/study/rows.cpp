#include "app/study/rows.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/film/estimate.h"
#include "app/film/output.h"
#include "media/error.h"
#include "media/file.h"

namespace obscura::app {

namespace {

// a cell of a table, quoted where it must be
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string json(const std::string& text) {
  if (text.empty()) return "null";
  if (nlohmann::json::accept(text)) return text;
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

[[noreturn]] void fail(const std::string& name, const char* what, int code) {
  throw media::Error(fmt::format("{}: {}: {}", name, what, std::generic_category().message(code)));
}

}  // namespace

std::string head(RowForm form, const std::vector<std::string>& heads) {
  if (form == RowForm::jsonl) return "";
  std::string line;
  for (std::size_t i = 0; i < heads.size(); ++i) line += (i ? "," : "") + cell(heads[i]);
  return line + "\n";
}

std::string row(RowForm form, const std::vector<std::string>& heads, const std::vector<std::string>& cells) {
  if (form == RowForm::csv) return head(form, cells);
  std::string line = "{";
  for (std::size_t i = 0; i < heads.size(); ++i)
    line += fmt::format("{}{}: {}", i ? ", " : "", nlohmann::json(heads[i]).dump(), json(cells[i]));
  return line + "}\n";
}

RowFile::RowFile(const std::optional<std::string>& path, Begin begin) {
  if (!path || *path == "-") {
    name_ = "standard output", descriptor_ = STDOUT_FILENO;
    return;
  }
  path_ = *path;
  name_ = Output{Output::Form::movie, path_}.partial();
  media::make_folder_of(path_);
  std::error_code none;
  if (std::filesystem::is_directory(path_, none)) fail(path_, "cannot write", EISDIR);
  descriptor_ = ::open(name_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(name_, "cannot write", errno);
  struct flock whole {};
  whole.l_type = F_WRLCK, whole.l_whence = SEEK_SET;
  if (::fcntl(descriptor_, F_OFD_SETLK, &whole) != 0 && (errno == EAGAIN || errno == EACCES)) {
    ::close(descriptor_);
    throw media::Error(fmt::format("{}: another obscura is writing it", name_));
  }

  // the earlier file, up to its last complete line
  off_t good = 0;
  std::ifstream in(name_, std::ios::binary);
  std::string line;
  while (std::getline(in, line) && !in.eof()) {
    good += off_t(line.size()) + 1;
    if (earlier_.lines++ == 0) earlier_.first = line;
    earlier_.last = line;
  }
  const std::filesystem::path partial(name_);
  spent_.emplace((partial.parent_path() / ("." + partial.filename().string() + ".seconds")).string());
  if (begin == Begin::fresh && good > 0 && spent_->before().value_or(2 * kWorthKeeping) > kWorthKeeping) {
    ::close(descriptor_);
    throw media::Error(fmt::format(
        "{}: holds {} lines of a sweep that is not whole{}: --resume continues from there, "
        "--anew discards them",
        name_, earlier_.lines, spent_->before() ? ", " + time_text(*spent_->before()) + " of work" : ""));
  }
  if (begin != Begin::go_on) good = 0, earlier_ = {};
  spent_->begin(good > 0 ? spent_->before().value_or(0) : 0);
  if (::ftruncate(descriptor_, good) != 0 || ::lseek(descriptor_, good, SEEK_SET) < 0)
    fail(name_, "cannot write", errno);
}

RowFile::~RowFile() {
  if (!path_.empty() && descriptor_ >= 0) ::close(descriptor_);
}

void RowFile::add(const std::string& line) {
  if (const int code =
          media::write_all(descriptor_, {reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}))
    fail(name_, "cannot write", code);
  if (spent_) spent_->note();
}

void RowFile::finish() {
  if (path_.empty()) return;
  spent_->remove();
  if (::fsync(descriptor_) != 0 && errno != EINVAL) fail(name_, "cannot write to disk", errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(name_, "cannot close", errno);
  if (::rename(name_.c_str(), path_.c_str()) != 0) fail(path_, "cannot rename into place", errno);
}

}  // namespace obscura::app
