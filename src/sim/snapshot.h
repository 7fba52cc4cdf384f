#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/model.h"
#include "sim/vec.h"

namespace obscura::sim {

// One instant, without a dimension: above it nothing knows D. The plane lies at z = 0, seen from +z.

/// What is the same at every instant: who is in the room and what they look like to a measuring eye.
struct Cast {
  struct Body {
    std::string name;
    ShapeKind kind = ShapeKind::point;
    double radius = 0;         // m
    Vec3 half = Vec3::Zero();  // m
    double mass = 0;           // kg
    bool fixed = false;
  };
  struct Wall {
    Vec3 point, normal;
  };
  struct Spring {
    int a = -1, b = -1;  // bodies; -1: the room
    double rest_length = 0, stiffness = 0;
  };
  struct Mouse {
    double press = 0, release = 0;  // s
    double rest_length = 0;
    std::vector<Vec3> path;  // the whole way of the hand, finely sampled, equal times
  };

  int dimension = 2;
  double scale = 1;  // the room's height, m
  std::vector<Body> bodies;
  std::vector<Wall> walls;
  std::vector<Spring> springs;
  std::vector<Mouse> mice;
};

struct Energies {
  double kinetic = 0, gravity = 0, springs = 0;  // J; springs: those of the scene and of pressed mice
  double displacement = 0, impacts = 0;          // the ledger of `handout`, J since t = 0
  double potential() const { return gravity + springs; }
  double total() const { return kinetic + potential(); }
};

struct Snapshot {
  struct Body {
    Vec3 position = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();
    Vec3 spin = Vec3::Zero();  // rad/s; in the plane (0, 0, w)
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    double angle = 0;  // plane: rad, not wrapped
  };
  struct Spring {
    Vec3 a = Vec3::Zero(), b = Vec3::Zero();  // where its ends are
  };
  struct Mouse {
    bool pressed = false;
    Vec3 pointer = Vec3::Zero();
    int body = -1;             // what it holds
    Vec3 held = Vec3::Zero();  // the point of the body it holds
  };
  struct Contact {
    int body = -1, wall = -1;
    Vec3 point = Vec3::Zero(), normal = Vec3::Zero();
    Vec3 impulse = Vec3::Zero();  // N s, in the last step
    double gap = 0;               // m, negative when inside
  };

  double time = 0;           // s
  std::int64_t step = 0;     // whole steps done
  std::vector<Body> bodies;  // as in the Cast
  std::vector<Spring> springs;
  std::vector<Mouse> mice;
  std::vector<Contact> contacts;
  Energies energies;
  Vec3 momentum = Vec3::Zero();          // kg m/s
  Vec3 angular_momentum = Vec3::Zero();  // about the origin, kg m^2/s; in the plane (0, 0, L)
};

/// The ways of chosen bodies on the physics clock, the same for every frame rate: what a trail is drawn from.
/// Points come at equal steps and at each impact, so that a bounce keeps its cusp.
struct Track {
  struct Point {
    double time = 0;
    Vec3 place = Vec3::Zero();
  };
  std::vector<int> bodies;
  std::vector<std::vector<Point>> points;  // one list a body of `bodies`, times increasing
};

}  // namespace obscura::sim
