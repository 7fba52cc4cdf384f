#pragma once

#include <span>
#include <utility>
#include <vector>

#include "draw/picture/lens.h"
#include "draw/space/polyhedron.h"

namespace obscura::draw {

/// Finds the visible parts of lines in a space of convex bodies. Everything is in the coordinates of
/// CameraProjection::seen, where sight lines are parallel to the third axis and the nearer of two points has
/// the larger third coordinate.
class HiddenLines {
 public:
  explicit HiddenLines(const CameraProjection& lens);

  /// A body hides what lies behind it. `body` is the number of this convex piece, for `seen`. Pieces that
  /// reach behind the eye are left out. Pieces of one `group` are one thing: where a line lies on the surface
  /// of another of them it is a seam, and is hidden too. -1: of none.
  void add(const Polyhedron& body, int number, int group = -1);
  /// `rim`: the ball's contour (see `contour`); `radius`: its own.
  void add_disc(const std::vector<sim::Vec3>& rim, const sim::Vec3& center, double radius, int number);
  /// A round rod from a to b, of these radii (m), without its ends.
  void add_rod(const sim::Vec3& a, const sim::Vec3& b, double radius_a, double radius_b, int number);
  /// To be called once, when all are added.
  void finish();

  using Parts = std::vector<std::pair<double, double>>;
  /// The parts of the line from a to b (world) that no piece hides but those numbered `own` and `too`, each
  /// as its ends between 0 and 1 along the line's picture on the page. Empty too where a or b is behind the
  /// eye. `faces`: the normals of the faces of `own` that meet in the line: where another piece of its group
  /// continues or covers one of them, the line is a seam up to that piece's very edge. `end`: so long (page
  /// units) before the outline of another thing a part ends, for its round end not to reach into that.
  void seen(const sim::Vec3& a, const sim::Vec3& b, int own, int too, Parts& parts,
            std::span<const sim::Vec3> faces = {}, double end = 0) const;
  /// Whether a place is seen.
  bool seen(const sim::Vec3& place, int own, int too = -1) const;

 private:
  /// A region that hides: all places with n . (x, y, z) < d for all of its planes; outlines are planes along
  /// the third axis.
  struct Piece {
    int number = 0, group = -1;
    int begin = 0, end = 0;  // into planes_
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    std::vector<Eigen::Vector4d> backs{};  // of its faces that are turned away, where it is one of a group
  };
  void close(Piece piece);
  void add_front(const sim::Vec3& normal, const sim::Vec3& point);
  int group_of(int number) const;

  CameraProjection lens_;
  std::vector<Eigen::Vector4d> planes_;
  std::vector<Piece> pieces_;
  std::vector<int> groups_;  // by number; -1: none
  int columns_ = 1, rows_ = 1;
  std::vector<std::vector<int>> cells_;
  // scratch
  mutable std::vector<int> stamp_;
  mutable int stamps_ = 0;
  mutable Parts hidden_;
  mutable std::vector<Eigen::Vector4d> planes_at_;
};

/// The points where sight lines touch a ball: `count` of them on a circle, counter-clockwise as seen.
std::vector<sim::Vec3> contour(const CameraProjection& lens, const sim::Vec3& center, double radius,
                               int count);

/// How many pieces make a circle of this radius on the page round to the eye.
int roundness(double page_radius);

}  // namespace obscura::draw
