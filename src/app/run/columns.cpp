#include "app/run/columns.h"

namespace obscura::app {

namespace {

using Now = const sim::Snapshot&;

class Listing {
 public:
  explicit Listing(int dimension) : dimension_(dimension) {}

  void number(std::string name, std::function<double(Now)> read) {
    all.push_back({std::move(name), std::move(read)});
  }
  void vector(const std::string& name, const std::function<const sim::Vec3&(Now)>& read) {
    for (int k = 0; k < dimension_; ++k)
      number(name + "." + "xyz"[k], [read, k](Now now) { return read(now)[k]; });
  }
  /// A spin or turning momentum: one number in the plane.
  void turning(const std::string& name, const std::function<const sim::Vec3&(Now)>& read) {
    if (dimension_ == 3) return vector(name, read);
    number(name, [read](Now now) { return read(now).z(); });
  }

  std::vector<Column> all;

 private:
  int dimension_;
};

}  // namespace

std::vector<Column> columns(const sim::SceneInfo& cast, const std::vector<Eigen::Quaterniond>& axes) {
  Listing list(cast.dimension);
  list.number("time", [](Now now) { return now.time; });
  list.number("step", [](Now now) { return double(now.step); });
  list.number("energy.kinetic", [](Now now) { return now.energies.kinetic; });
  list.number("energy.potential", [](Now now) { return now.energies.potential(); });
  list.number("energy.total", [](Now now) { return now.energies.total(); });
  if (cast.forces) list.number("energy.fields", [](Now now) { return now.energies.fields; });
  if (cast.books_work) list.number("energy.work", [](Now now) { return now.energies.work; });
  if (!cast.mice.empty()) list.number("energy.hand", [](Now now) { return now.energies.hand; });
  list.number("energy.displacement", [](Now now) { return now.energies.displacement; });
  list.number("energy.impacts", [](Now now) { return now.energies.impacts; });
  list.vector("momentum", [](Now now) -> const sim::Vec3& { return now.momentum; });
  list.turning("angular_momentum", [](Now now) -> const sim::Vec3& { return now.angular_momentum; });
  list.number("contacts", [](Now now) { return double(now.contacts.size()); });
  for (std::size_t i = 0; i < cast.bodies.size(); ++i) {
    const std::string& name = cast.bodies[i].name;
    list.vector(name + ".position", [i](Now now) -> const sim::Vec3& { return now.bodies[i].position; });
    if (cast.dimension == 3) {
      for (int k = 0; k < 4; ++k)
        list.number(name + ".orientation." + "xyzw"[k], [i, k, own = axes[i].conjugate()](Now now) {
          return (now.bodies[i].orientation * own).coeffs()[k];
        });
    } else {
      list.number(name + ".angle", [i](Now now) { return now.bodies[i].angle; });
    }
    list.vector(name + ".velocity", [i](Now now) -> const sim::Vec3& { return now.bodies[i].velocity; });
    list.turning(name + ".spin", [i](Now now) -> const sim::Vec3& { return now.bodies[i].spin; });
  }
  for (std::size_t i = 0; i < cast.joints.size(); ++i) {
    const std::string& name = cast.joints[i].name;
    list.vector(name + ".force", [i](Now now) -> const sim::Vec3& { return now.joints[i].force; });
    list.turning(name + ".torque", [i](Now now) -> const sim::Vec3& { return now.joints[i].torque; });
  }
  return std::move(list.all);
}

}  // namespace obscura::app
