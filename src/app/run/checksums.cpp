#include "app/run/checksums.h"

#include <xxhash.h>

#include <algorithm>
#include <charconv>

#include <nlohmann/json.hpp>

#include "app/run/origin.h"

namespace obscura::app {

namespace {

// limits for one film: frames with a checksum of their own, and bodies times frames
constexpr std::int64_t kMostFrames = 2048, kMostBodies = 4096;
constexpr std::int64_t kLetters = 2;                      // of a checksum of 12 bits
constexpr std::int64_t kMostOfAFilm = 1'000'000'000'000;  // more frames than any film has

std::string letters(std::uint64_t sum) {
  constexpr std::string_view kAll = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  return {kAll[sum >> 6 & 63], kAll[sum & 63]};
}

// the first 12 bits of a hash
std::string of_state(const std::string& state) {
  unsigned bits = 0;
  std::from_chars(state.data(), state.data() + std::min<std::size_t>(3, state.size()), bits, 16);
  return letters(bits);
}

std::string of_body(const sim::Snapshot::Body& body) {
  const Eigen::Quaterniond& q = body.orientation;
  double all[] = {body.position.x(),
                  body.position.y(),
                  body.position.z(),
                  body.velocity.x(),
                  body.velocity.y(),
                  body.velocity.z(),
                  body.spin.x(),
                  body.spin.y(),
                  body.spin.z(),
                  body.angle,
                  q.x(),
                  q.y(),
                  q.z(),
                  q.w(),
                  double(body.at_rest)};
  for (double& x : all) x += 0.0;  // -0 is 0
  return letters(XXH3_64bits(all, sizeof all));
}

std::int64_t stride(std::int64_t frames, std::int64_t most) {
  return std::max<std::int64_t>(1, (frames + most - 1) / most);
}

}  // namespace

Checksums::Checksums(std::int64_t frames, std::size_t bodies) {
  of_frames_ = {stride(frames, kMostFrames), kLetters, ""};
  const auto n = std::int64_t(bodies);
  if (n > 0 && n <= kMostBodies) of_bodies_ = {stride(frames, kMostBodies / n), kLetters * n, ""};
}

void Checksums::add(std::int64_t index, const std::string& state, const sim::Snapshot& moment) {
  ++frames_;
  states_ += state;
  if (index % of_frames_.each == 0) of_frames_.letters += of_state(state);
  if (of_bodies_.width == 0 || index % of_bodies_.each != 0) return;
  for (const sim::Snapshot::Body& body : moment.bodies) of_bodies_.letters += of_body(body);
}

void Checksums::append(const Checksums& next) {
  frames_ += next.frames_;
  states_ += next.states_;
  of_frames_.letters += next.of_frames_.letters, of_bodies_.letters += next.of_bodies_.letters;
}

void Checksums::close() { states_ = hash(states_); }

Checksums checksums(const std::string& state, const sim::Snapshot& moment) {
  Checksums it(1, moment.bodies.size());
  it.add(0, state, moment);
  it.close();
  return it;
}

std::string_view Checksums::Rows::row(std::int64_t i) const {
  return std::string_view(letters).substr(std::size_t(i * width), std::size_t(width));
}

nlohmann::ordered_json Checksums::json() const {
  nlohmann::ordered_json json;
  json["frames"] = frames_, json["hash"] = states_;
  const auto rows = [](const Rows& it) {
    return nlohmann::ordered_json{{"each", it.each}, {"width", it.width}, {"sums", it.letters}};
  };
  json["of_frames"] = rows(of_frames_);
  if (of_bodies_.width > 0) json["of_bodies"] = rows(of_bodies_);
  return json;
}

std::optional<Checksums> Checksums::read(const nlohmann::json& json) {
  const auto rows = [](const nlohmann::json& it) -> std::optional<Rows> {
    const auto each = whole(it.at("each"), 1, kMostOfAFilm),
               width = whole(it.at("width"), 1, kLetters * kMostBodies);
    if (!each || !width) return {};
    return Rows{*each, *width, it.at("sums").get<std::string>()};
  };
  try {
    Checksums it;
    const auto frames = whole(json.at("frames"), 1, kMostOfAFilm);
    const auto of_frames = rows(json.at("of_frames"));
    const auto of_bodies = json.contains("of_bodies") ? rows(json["of_bodies"]) : Rows{};
    if (!frames || !of_frames || !of_bodies) return {};
    it.frames_ = *frames, it.of_frames_ = *of_frames, it.of_bodies_ = *of_bodies;
    json.at("hash").get_to(it.states_);
    return it;
  } catch (const nlohmann::json::exception&) {
    return {};
  }
}

std::optional<Checksums::Apart> Checksums::apart(const Checksums& a, const Checksums& b) {
  if (a == b) return {};
  const std::int64_t both = std::min(a.frames_, b.frames_);
  const bool ended = a.frames_ != b.frames_;
  // the first row from `from` on that is another one
  const auto first_other = [both](const Rows& left, const Rows& right,
                                  std::int64_t from) -> std::optional<std::int64_t> {
    if (left.each != right.each || left.width != right.width) return {};
    const std::int64_t rows = std::min({left.size(), right.size(), (both + left.each - 1) / left.each});
    for (std::int64_t i = (from + left.each - 1) / left.each; i < rows; ++i)
      if (left.row(i) != right.row(i)) return i;
    return {};
  };

  Apart found;
  if (const auto row = first_other(a.of_frames_, b.of_frames_, 0)) {
    found.first = *row * a.of_frames_.each;
    found.same = *found.first - a.of_frames_.each;
  } else if (ended) {
    found.first = both, found.ended = true;
    return found;
  }
  found.bodies_known = a.of_bodies_.width > 0 && a.of_bodies_.each == b.of_bodies_.each &&
                       a.of_bodies_.width == b.of_bodies_.width;
  const auto row =
      found.bodies_known ? first_other(a.of_bodies_, b.of_bodies_, found.same + 1) : std::nullopt;
  if (!row) return found;
  found.bodies_at = *row * a.of_bodies_.each;
  if (!found.first) found.same = found.bodies_at - a.of_bodies_.each;
  if (!found.first || found.bodies_at < *found.first) found.first = found.bodies_at;
  const std::string_view left = a.of_bodies_.row(*row), right = b.of_bodies_.row(*row);
  for (std::size_t i = 0; i + kLetters <= left.size(); i += kLetters)
    if (left.substr(i, kLetters) != right.substr(i, kLetters)) found.bodies.push_back(i / kLetters);
  return found;
}

}  // namespace obscura::app
