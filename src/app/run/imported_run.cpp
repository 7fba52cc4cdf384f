#include "app/run/imported_run.h"
#include "app/console/say.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include "app/run/columns.h"
#include "draw/page/measure.h"
#include "draw/page/readings.h"
#include "media/error.h"
#include "scene/complaints.h"
#include "sim/step/playback.h"
#include "sim/step/run.h"

namespace obscura::app {

namespace {

constexpr double kOffLength = 0.01;  // of an orientation, for rounding in a table

std::string body_of(const std::string& column) { return column.substr(0, column.find('.')); }
std::string quantity_of(const std::string& column) { return column.substr(column.find('.') + 1); }

std::string path(const std::string& body, const std::string& quantity, const std::string& part) {
  return body + "." + quantity + (part.empty() ? "" : "." + part);
}

using Columns = std::vector<std::size_t>;

/// Matches a table's columns to a scene's bodies, and takes its rows for poses of them.
class Footage {
 public:
  Footage(const Table& table, const scene::Scene& scene)
      : table_(table), scene_(scene), run_(scene.run()), cast_(run_->scene_info()) {
    for (std::size_t i = 0; i < table.columns.size(); ++i) index_[table.columns[i]] = i;
  }

  /// Throws media::Error where a column of a body is none that it can have here, and may be another that is
  /// misspelt; notes those of which a film shows nothing.
  void check_columns(std::vector<std::string>& notes) const;
  /// The rows as poses.
  std::vector<std::vector<sim::Sighting>> poses(std::vector<std::string>& notes) const;

 private:
  bool space() const { return cast_.dimension == 3; }
  [[noreturn]] void refuse(int line, std::size_t column, const std::string& why) const {
    throw media::Error(fmt::format("{}: {}", place(table_, line, column), why));
  }
  void check_dimension(std::size_t column) const;
  std::optional<Columns> columns(const std::string& body, const std::string& quantity,
                                 const std::vector<std::string>& parts,
                                 std::vector<std::string>& missing) const;
  double cell(std::size_t row, std::size_t column) const;
  sim::Vec3 vector(std::size_t row, const Columns& columns) const;
  Eigen::Quaterniond quaternion(std::size_t row, const Columns& columns) const;

  const Table& table_;
  const scene::Scene& scene_;
  std::unique_ptr<sim::Run> run_;
  const sim::SceneInfo& cast_;
  std::unordered_map<std::string, std::size_t> index_;  // of columns
};

// a table in space for a scene in the plane, or the reverse, would lose something
void Footage::check_dimension(std::size_t column) const {
  const std::string& name = table_.columns[column];
  const std::string body = body_of(name), quantity = quantity_of(name);
  if (space()) {
    if (quantity == "angle")
      refuse(table_.head, column,
             name + ": the scene is in space, where a body turns by its orientation.x, .y, .z, .w");
    if (quantity == "spin")
      refuse(table_.head, column, name + ": the scene is in space, where a spin has x, y and z");
    return;
  }
  if (quantity.starts_with("orientation."))
    refuse(table_.head, column,
           fmt::format("{}: the scene is in the plane, where a body turns by its angle", name));
  if (quantity.starts_with("spin."))
    refuse(table_.head, column,
           fmt::format("{}: the scene is in the plane, where {}.spin is one number", name, body));
  if (quantity != "position.z" && quantity != "velocity.z") return;
  for (std::size_t row = 0; row < table_.rows.size(); ++row)
    if (table_.rows[row][column] != 0)
      refuse(table_.lines[row], column,
             fmt::format("{} is {}: the scene is in the plane, and a film of it loses z", name,
                         table_.rows[row][column]));
}

void Footage::check_columns(std::vector<std::string>& notes) const {
  // for each name that columns begin with: the allowed rest
  std::map<std::string, std::vector<std::string>> known;
  for (const Column& column : app::columns(cast_, scene_.axes))
    known[body_of(column.name)].push_back(quantity_of(column.name));
  std::set<std::string> bodies;
  for (const auto& body : cast_.bodies) bodies.insert(body.name);

  std::vector<std::string> strangers, unknown;
  for (std::size_t i = 0; i < table_.columns.size(); ++i) {
    const std::string& name = table_.columns[i];
    const std::string body = body_of(name), quantity = quantity_of(name);
    const auto there = known.find(body);
    if (there == known.end()) {
      if (name == body)
        unknown.push_back(name);
      else if (strangers.empty() || strangers.back() != body)
        strangers.push_back(body);
      continue;
    }
    if (!bodies.contains(body) || std::count(there->second.begin(), there->second.end(), quantity) > 0)
      continue;
    check_dimension(i);
    if (quantity == "position.z" || quantity == "velocity.z") continue;
    // beside what it is like it is something else
    std::vector<std::string_view> wanting;
    for (const std::string& other : there->second)
      if (!index_.contains(body + "." + other)) wanting.push_back(other);
    if (const std::string_view near = scene::nearest(quantity, wanting); !near.empty())
      refuse(table_.head, i, fmt::format("a body has no '{}'; did you mean '{}.{}'?", name, body, near));
    unknown.push_back(name);
  }
  if (!strangers.empty())
    notes.push_back(fmt::format("left out, because the scene has no such body: {}", some_of(strangers)));
  if (!unknown.empty())
    notes.push_back(fmt::format("left out, because a film does not show it: {}", some_of(unknown)));
}

// for "position" its x, y and in space z; none if the table has none of them
std::optional<Columns> Footage::columns(const std::string& body, const std::string& quantity,
                                        const std::vector<std::string>& parts,
                                        std::vector<std::string>& missing) const {
  Columns found;
  std::vector<std::string> absent;
  for (const std::string& part : parts) {
    const std::string name = path(body, quantity, part);
    if (const auto column = index_.find(name); column != index_.end())
      found.push_back(column->second);
    else
      absent.push_back(name);
  }
  if (absent.empty()) return found;
  if (!found.empty()) missing.insert(missing.end(), absent.begin(), absent.end());
  return {};
}

double Footage::cell(std::size_t row, std::size_t column) const {
  const double x = table_.rows[row][column];
  if (!std::isfinite(x))
    refuse(table_.lines[row], column,
           fmt::format("{} is {}: expected a finite number", table_.columns[column], x));
  return x;
}

sim::Vec3 Footage::vector(std::size_t row, const Columns& columns) const {
  sim::Vec3 v = sim::Vec3::Zero();
  for (std::size_t k = 0; k < columns.size(); ++k) v[int(k)] = cell(row, columns[k]);
  return v;
}

Eigen::Quaterniond Footage::quaternion(std::size_t row, const Columns& columns) const {
  const Eigen::Quaterniond q(cell(row, columns[3]), cell(row, columns[0]), cell(row, columns[1]),
                             cell(row, columns[2]));
  if (!(std::abs(q.norm() - 1) < kOffLength))
    refuse(table_.lines[row], columns[0],
           fmt::format("{} and so on are a quaternion of length {:.3g}: an orientation has length 1",
                       table_.columns[columns[0]], q.norm()));
  return q.normalized();
}

std::vector<std::vector<sim::Sighting>> Footage::poses(std::vector<std::string>& notes) const {
  const auto start = std::get<sim::Snapshot>(run_->at({0, 1}));
  const std::vector<std::string> axes =
      space() ? std::vector<std::string>{"x", "y", "z"} : std::vector<std::string>{"x", "y"};
  std::vector<std::vector<sim::Sighting>> poses(table_.rows.size(),
                                                std::vector<sim::Sighting>(cast_.bodies.size()));
  std::vector<std::string> missing, upright, still;
  for (std::size_t i = 0; i < cast_.bodies.size(); ++i) {
    const sim::SceneInfo::Body& body = cast_.bodies[i];
    const std::size_t before = missing.size();
    const auto position = columns(body.name, "position", axes, missing);
    if (!position && !body.fixed && missing.size() == before)
      for (const std::string& axis : axes) missing.push_back(path(body.name, "position", axis));
    const auto velocity = columns(body.name, "velocity", axes, missing);
    const auto turn = space() ? columns(body.name, "orientation", {"x", "y", "z", "w"}, missing)
                              : columns(body.name, "angle", {""}, missing);
    const auto spin = columns(body.name, "spin", space() ? axes : std::vector<std::string>{""}, missing);
    if (!missing.empty()) continue;
    if (position && body.turns && !turn) upright.push_back(body.name);
    if (position && !velocity && scene_.look.bodies[i].velocity) still.push_back(body.name);
    for (std::size_t row = 0; row < table_.rows.size(); ++row) {
      sim::Sighting& pose = poses[row][i];
      pose.position = position ? vector(row, *position) : start.bodies[i].position;
      pose.angle = start.bodies[i].angle, pose.orientation = start.bodies[i].orientation;
      if (velocity) pose.velocity = vector(row, *velocity);
      if (turn && !space()) pose.angle = cell(row, (*turn)[0]);
      // as typed, and not as its principal axes lie: the way back of what `states` does
      if (turn && space()) pose.orientation = quaternion(row, *turn) * scene_.axes[i];
      if (spin) pose.spin = space() ? vector(row, *spin) : sim::Vec3(0, 0, cell(row, (*spin)[0]));
    }
  }
  if (!missing.empty()) {
    // perhaps the table calls the body otherwise
    std::vector<std::string> others;
    for (const std::string& column : table_.columns)
      if (column.find(".position.") != std::string::npos) others.push_back(body_of(column));
    std::erase_if(others, [&](const std::string& name) {
      return std::any_of(cast_.bodies.begin(), cast_.bodies.end(),
                         [&](const auto& body) { return body.name == name; });
    });
    const std::string body = body_of(missing[0]);
    const std::string_view near = scene::nearest(body, {others.begin(), others.end()});
    throw media::Error(
        fmt::format("{}:{}: has no column {}{}", table_.file, table_.head, some_of(missing),
                    near.empty() ? "" : fmt::format("; is its '{}' the scene's '{}'?", near, body)));
  }
  if (!upright.empty())
    notes.push_back(fmt::format("{} does not say how {} turns", table_.file, some_of(upright)));
  if (!still.empty())
    notes.push_back(fmt::format("{} has no velocity of {}: no arrow there", table_.file, some_of(still)));
  return poses;
}

}  // namespace

namespace {

// Whether only the steps of a run tell a measure: a state does not.
bool of_steps(const std::string& quantity) {
  const draw::Measure* measure = draw::measure(quantity);
  return quantity == "work" || (measure && measure->arrow && draw::of_steps(*measure->arrow));
}

// Takes out the marks and plots of what the states do not tell; `left` are their quantities.
void leave_out(draw::Marks& marks, std::set<std::string>& left) {
  std::erase_if(marks.vectors, [&](const draw::Marks::Vector& each) {
    if (!draw::of_steps(each.quantity)) return false;
    for (const std::string& name : draw::arrows())
      if (draw::measure(name)->arrow == each.quantity) left.insert(draw::in_words(name));
    return true;
  });
  std::erase_if(marks.labels, [&](const draw::Marks::Label& each) {
    return of_steps(each.quantity) && left.insert(draw::in_words(each.quantity)).first != left.end();
  });
  if (!marks.cones.empty()) left.insert("contact");
  marks.cones.clear();
}
void leave_out(draw::Measured& plot, std::set<std::string>& left) {
  std::erase_if(plot.quantities, [&](const std::string& each) {
    return of_steps(each) && left.insert(draw::in_words(each)).first != left.end();
  });
  if (of_steps(plot.against)) left.insert(draw::in_words(plot.against)), plot.quantities.clear();
}

void leave_out_forces(scene::Scene& scene, std::vector<std::string>& notes) {
  std::set<std::string> left;
  leave_out(scene.film.marks, left);
  for (draw::Chart& chart : scene.film.charts) leave_out(chart, left);
  std::erase_if(scene.film.charts, [](const draw::Chart& chart) { return chart.quantities.empty(); });
  for (draw::BodyLook& body : scene.look.bodies)
    if (std::exchange(body.contact, false)) left.insert("contact");
  if (!left.empty())
    notes.push_back(fmt::format("places and velocities do not tell {}: its marks and plots are left out",
                                fmt::join(left, ", ")));
}

}  // namespace

void show_run(const Table& table, bool interpolate, scene::Scene& scene, std::vector<std::string>& notes) {
  const Footage footage(table, scene);
  footage.check_columns(notes);
  auto trajectory = std::make_shared<sim::Trajectory>();
  trajectory->interpolate = interpolate;
  for (std::size_t row = 0; row < table.rows.size(); ++row) trajectory->times.push_back(table.time(row));
  trajectory->poses = footage.poses(notes);
  scene.trajectory = std::move(trajectory);
  leave_out_forces(scene, notes);
  scene.trajectory_file = scene::one_line(std::filesystem::path(table.file).filename().string());
}

}  // namespace obscura::app
