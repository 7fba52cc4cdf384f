// Workflow commands of GitHub Actions.
// Source: docs.github.com, "Workflow commands for GitHub Actions"; escaped are the sequences that the runner
// unescapes: %25 %0D %0A in messages, in properties %3A %2C too.

#include "app/compare/github.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>

#include <fmt/format.h>

#include "media/error.h"
#include "page/markup.h"
#include "scene/complaints.h"

namespace obscura::app::github {

namespace {

std::string data(std::string_view text, bool property) {
  std::string out;
  for (const char c : text) {
    if (c == '%')
      out += "%25";
    else if (c == '\n')
      out += "%0A";
    else if (property && c == ':')
      out += "%3A";
    else if (property && c == ',')
      out += "%2C";
    else
      out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return out;
}

// from the top of the checkout, which is where GitHub looks for a file; it finds none by "./a.toml"
std::string from_top(const std::string& file) {
  namespace fs = std::filesystem;
  const char* top = std::getenv("GITHUB_WORKSPACE");
  if (file.empty()) return file;
  if (!top) return fs::path(file).lexically_normal().generic_string();
  std::error_code none;
  const auto whole = [&](const fs::path& path) { return fs::weakly_canonical(fs::absolute(path), none); };
  const fs::path inside = whole(file).lexically_relative(whole(top));
  return inside.empty() || *inside.begin() == ".." ? fs::path(file).lexically_normal().generic_string()
                                                   : inside.generic_string();
}

constexpr const char* kLevels[] = {"error", "warning", "notice"};

}  // namespace

std::string command(const Annotation& annotation) {
  std::string properties;
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) properties += fmt::format("{}{}={}", properties.empty() ? " " : ",", name, value);
  };
  add("file", data(from_top(annotation.file), true));
  if (annotation.line > 0) add("line", fmt::format("{}", annotation.line));
  if (annotation.line > 0 && annotation.column > 0) add("col", fmt::format("{}", annotation.column));
  add("title", data(annotation.title, true));
  return fmt::format("::{}{}::{}\n", kLevels[int(annotation.level)], properties,
                     data(annotation.message, false));
}

std::string commands(const scene::Error& error) {
  std::string all;
  for (const scene::Complaint& it : error.complaints) {
    // an error of --set is in no file
    const bool file = it.line > 0 || std::filesystem::exists(it.file);
    all += command({.file = file ? it.file : "",
                    .line = it.line,
                    .column = it.column,
                    .title = "scene",
                    .message = file ? it.message : it.text()});
  }
  return all;
}

std::string verbatim(const std::string& text) {
  std::random_device random;
  const std::string token = fmt::format("{:08x}{:08x}{:08x}{:08x}", random(), random(), random(), random());
  return fmt::format("::stop-commands::{0}\n{1}{2}::{0}::\n", token, text,
                     text.empty() || text.back() == '\n' ? "" : "\n");
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : scene::one_line(text)) {
    if (std::strchr("\\`*_{}[]()<>#+-!|~@&:", c) && c != '\0')
      out += fmt::format("&#{};", int(c));
    else
      out += c;
  }
  return out;
}

std::string quoted(const std::string& text) { return "<pre>" + page::escaped(text) + "</pre>\n\n"; }

void add_to_summary(const std::string& markdown) {
  const char* path = std::getenv("GITHUB_STEP_SUMMARY");
  if (!path || !*path) return;
  std::FILE* file = std::fopen(path, "ab");
  const bool written = file && std::fwrite(markdown.data(), 1, markdown.size(), file) == markdown.size();
  const bool closed = file && std::fclose(file) == 0;
  if (!written || !closed)
    throw media::Error(fmt::format("{}: cannot write the summary: {}", path, std::strerror(errno)));
}

}  // namespace obscura::app::github
