#include "app/footage.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "media/error.h"
#include "scene/complaints.h"
#include "sim/playback.h"

namespace obscura::app {

namespace {

constexpr std::size_t kMostNames = 6;

std::string several(const std::vector<std::string>& all) {
  std::string text;
  for (std::size_t i = 0; i < all.size() && i < kMostNames; ++i) text += (i ? ", " : "") + all[i];
  return all.size() > kMostNames ? text + fmt::format(" and {} more", all.size() - kMostNames) : text;
}

std::string body_of(const std::string& column) { return column.substr(0, column.find('.')); }

// the columns of one body, where there are such
class Columns {
 public:
  Columns(const Table& table, std::string body) : table_(table), body_(std::move(body)) {}

  // of "position" its x, y and in space z; none where one is missing
  std::optional<std::vector<std::size_t>> all(const std::string& quantity,
                                              std::vector<std::string> parts) const {
    std::vector<std::size_t> found;
    for (const std::string& part : parts) {
      const auto column = table_.column(body_ + "." + quantity + (part.empty() ? "" : "." + part));
      if (!column) return {};
      found.push_back(*column);
    }
    return found;
  }

 private:
  const Table& table_;
  std::string body_;
};

sim::Vec3 vector(const std::vector<double>& row, const std::vector<std::size_t>& columns) {
  sim::Vec3 v = sim::Vec3::Zero();
  for (std::size_t k = 0; k < columns.size(); ++k) v[int(k)] = row[columns[k]];
  return v;
}

}  // namespace

void show_run(const Table& table, bool interpolate, scene::Scene& scene, std::vector<std::string>& notes) {
  const auto run = scene.run();
  const sim::Cast& cast = run->cast();
  const auto start = std::get<sim::Snapshot>(run->at({0, 1}));
  const bool space = cast.dimension == 3;
  const std::vector<std::string> axes =
      space ? std::vector<std::string>{"x", "y", "z"} : std::vector<std::string>{"x", "y"};

  auto trajectory = std::make_shared<sim::Trajectory>();
  trajectory->interpolate = interpolate;
  for (std::size_t row = 0; row < table.rows.size(); ++row) trajectory->times.push_back(table.time(row));
  trajectory->poses.assign(table.rows.size(), std::vector<sim::Sighting>(cast.bodies.size()));

  std::vector<std::string> absent, upright, still;
  for (std::size_t i = 0; i < cast.bodies.size(); ++i) {
    const sim::Cast::Body& body = cast.bodies[i];
    const Columns columns(table, body.name);
    const auto position = columns.all("position", axes);
    const auto velocity = columns.all("velocity", axes);
    const auto turn = space ? columns.all("orientation", {"x", "y", "z", "w"}) : columns.all("angle", {""});
    const auto spin = space ? columns.all("spin", axes) : columns.all("spin", {""});
    if (!position && !body.fixed) absent.push_back(body.name);
    if (position && body.turns && !turn) upright.push_back(body.name);
    if (position && !velocity && scene.look.bodies[i].velocity) still.push_back(body.name);
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      const std::vector<double>& cells = table.rows[row];
      sim::Sighting& pose = trajectory->poses[row][i];
      pose.position = position ? vector(cells, *position) : start.bodies[i].position;
      pose.angle = start.bodies[i].angle, pose.orientation = start.bodies[i].orientation;
      if (velocity) pose.velocity = vector(cells, *velocity);
      if (turn && !space) pose.angle = cells[(*turn)[0]];
      if (turn && space) {
        // as typed, and not as its principal axes lie: the way back of what `states` does
        Eigen::Quaterniond q(cells[(*turn)[3]], cells[(*turn)[0]], cells[(*turn)[1]], cells[(*turn)[2]]);
        if (q.norm() > 0) pose.orientation = q.normalized() * scene.axes[i];
      }
      if (spin) pose.spin = space ? vector(cells, *spin) : sim::Vec3(0, 0, cells[(*spin)[0]]);
    }
  }
  if (!absent.empty()) {
    std::vector<std::string> there;
    for (const std::string& column : table.columns)
      if (column.find(".position.") != std::string::npos) there.push_back(body_of(column));
    there.erase(std::unique(there.begin(), there.end()), there.end());
    throw media::Error(fmt::format("{}: has no position of {}{}", table.file, several(absent),
                                   there.empty()
                                       ? "; expected columns such as " + absent[0] + ".position.x"
                                       : scene::did_you_mean(absent[0], {there.begin(), there.end()})));
  }
  if (!upright.empty())
    notes.push_back(fmt::format("{} does not say how {} turns", table.file, several(upright)));
  if (!still.empty())
    notes.push_back(fmt::format("{} has no velocity of {}: no arrow there", table.file, several(still)));

  // columns of somebody who is not in the scene
  std::set<std::string> known = {"energy", "momentum", "angular_momentum"};
  for (const auto& body : cast.bodies) known.insert(body.name);
  for (const auto& joint : cast.joints) known.insert(joint.name);
  std::vector<std::string> strangers;
  for (const std::string& column : table.columns) {
    const std::string name = body_of(column);
    if (column.find('.') == std::string::npos || known.contains(name)) continue;
    if (strangers.empty() || strangers.back() != name) strangers.push_back(name);
  }
  if (!strangers.empty())
    notes.push_back(fmt::format("left out, for the scene has no such body: {}", several(strangers)));

  scene.trajectory = std::move(trajectory);
  scene.trajectory_file = scene::one_line(std::filesystem::path(table.file).filename().string());
}

}  // namespace obscura::app
