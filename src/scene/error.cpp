#include "scene/error.h"

namespace obscura::scene {

namespace {

std::string join(const std::vector<Complaint>& all) {
  std::string text;
  for (const Complaint& complaint : all) {
    if (!text.empty()) text += '\n';
    text += complaint.text();
  }
  return text;
}

}  // namespace

std::string Complaint::text() const {
  if (line <= 0) return file + ": " + message;
  return file + ':' + std::to_string(line) + ':' + std::to_string(column) + ": " + message;
}

Error::Error(std::vector<Complaint> all) : std::runtime_error(join(all)), complaints(std::move(all)) {}

}  // namespace obscura::scene
