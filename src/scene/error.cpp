#include "scene/error.h"

#include "scene/complaints.h"

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
  const std::string at = line <= 0 ? "" : ':' + std::to_string(line) + ':' + std::to_string(column);
  return one_line(file + at + ": " + message);
}

Error::Error(std::vector<Complaint> all) : std::runtime_error(join(all)), complaints(std::move(all)) {}

}  // namespace obscura::scene
