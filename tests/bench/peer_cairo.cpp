// The crowd filmed by hand with Chipmunk, Cairo and a raw pipe into ffmpeg: peer_cairo OUT.mp4 SECONDS.

#include <cairo/cairo.h>
#include <chipmunk/chipmunk.h>

#include <cmath>
#include <cstdlib>

#include "crowd.h"

namespace {

using namespace crowd;

void color(cairo_t* page, Rgb c) { cairo_set_source_rgb(page, c.r, c.g, c.b); }

// Walls, hatching, ground: drawn once.
cairo_surface_t* still_picture() {
  cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, kWidth, kHeight);
  cairo_t* page = cairo_create(surface);
  color(page, {1, 1, 1});
  cairo_paint(page);
  const double w = kRoomWidth * kScale, h = kRoomHeight * kScale;
  cairo_rectangle(page, kLeft - 22, kTop - 22, w + 44, h + 44);
  cairo_clip(page);
  color(page, {.5, .52, .54});
  cairo_set_line_width(page, 1.6);
  for (double x = -h; x < w + h; x += 14 * std::sqrt(2.0)) {
    cairo_move_to(page, kLeft + x, kTop + h + 22);
    cairo_line_to(page, kLeft + x + h + 44, kTop - 22);
  }
  cairo_stroke(page);
  cairo_reset_clip(page);
  cairo_rectangle(page, kLeft, kTop, w, h);
  color(page, {1, 1, 1});
  cairo_fill_preserve(page);
  color(page, {.122, .137, .157});
  cairo_set_line_width(page, kWall);
  cairo_stroke(page);
  cairo_destroy(page);
  return surface;
}

cpBody* add(cpSpace* space, const Start& s, bool box) {
  const double mass = box ? kBoxWidth * kBoxHeight : 1;
  cpBody* body =
      cpSpaceAddBody(space, cpBodyNew(mass, box ? cpMomentForBox(mass, kBoxWidth, kBoxHeight)
                                                : cpMomentForCircle(mass, 0, kBallRadius, cpvzero)));
  cpBodySetPosition(body, cpv(s.x, s.y));
  cpBodySetVelocity(body, cpv(s.vx, s.vy));
  cpBodySetAngularVelocity(body, s.spin);
  cpShape* shape = cpSpaceAddShape(space, box ? cpBoxShapeNew(body, kBoxWidth, kBoxHeight, 0)
                                              : cpCircleShapeNew(body, kBallRadius, cpvzero));
  cpShapeSetElasticity(shape, kElasticity);
  cpShapeSetFilter(
      shape, cpShapeFilterNew(1, CP_ALL_CATEGORIES, CP_ALL_CATEGORIES));  // bodies pass through each other
  return body;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const int frames = int(std::atof(argv[2]) * kFps);
  std::FILE* out = film(argv[1], "bgr0");
  if (!out) return 4;

  cpSpace* space = cpSpaceNew();
  cpSpaceSetGravity(space, cpv(0, kGravity));
  // walls a metre thick, so that nothing small passes them in one step
  const cpVect corners[4] = {
      {-1, -1}, {kRoomWidth + 1, -1}, {kRoomWidth + 1, kRoomHeight + 1}, {-1, kRoomHeight + 1}};
  for (int i = 0; i < 4; ++i) {
    cpShape* wall = cpSpaceAddShape(
        space, cpSegmentShapeNew(cpSpaceGetStaticBody(space), corners[i], corners[(i + 1) % 4], 1));
    cpShapeSetElasticity(wall, 1);
  }
  const auto ball_starts = balls(), box_starts = boxes();
  std::vector<cpBody*> ball_bodies, box_bodies;
  for (const Start& s : ball_starts) ball_bodies.push_back(add(space, s, false));
  for (const Start& s : box_starts) box_bodies.push_back(add(space, s, true));

  cairo_surface_t* still = still_picture();
  cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, kWidth, kHeight);
  for (int frame = 0; frame < frames; ++frame) {
    cairo_t* page = cairo_create(surface);
    cairo_set_source_surface(page, still, 0, 0);
    cairo_paint(page);
    cairo_translate(page, kLeft, kTop + kRoomHeight * kScale);
    cairo_set_line_width(page, kOutline);
    for (std::size_t i = 0; i < ball_bodies.size(); ++i) {
      const cpVect p = cpBodyGetPosition(ball_bodies[i]);
      cairo_arc(page, p.x * kScale, -p.y * kScale, kBallRadius * kScale - kOutline / 2, 0, 2 * M_PI);
      color(page, fill(ball_starts[i].color));
      cairo_fill_preserve(page);
      color(page, outline(ball_starts[i].color));
      cairo_stroke(page);
    }
    for (std::size_t i = 0; i < box_bodies.size(); ++i) {
      const cpVect p = cpBodyGetPosition(box_bodies[i]);
      const double w = kBoxWidth * kScale, h = kBoxHeight * kScale;
      cairo_save(page);
      cairo_translate(page, p.x * kScale, -p.y * kScale);
      cairo_rotate(page, -cpBodyGetAngle(box_bodies[i]));
      cairo_rectangle(page, -w / 2 + kOutline / 2, -h / 2 + kOutline / 2, w - kOutline, h - kOutline);
      color(page, fill(box_starts[i].color));
      cairo_fill_preserve(page);
      color(page, outline(box_starts[i].color));
      cairo_stroke(page);
      cairo_move_to(page, 0.3 * h, 0);
      cairo_line_to(page, 0, 0);
      cairo_line_to(page, 0, -0.3 * h);
      cairo_stroke(page);
      cairo_restore(page);
    }
    cairo_destroy(page);
    cairo_surface_flush(surface);
    std::fwrite(cairo_image_surface_get_data(surface), 4, std::size_t(kWidth) * kHeight, out);
    cpSpaceStep(space, 1.0 / kFps);
  }
  return argv[1] == std::string("-") ? std::fclose(out) != 0 : pclose(out) != 0;
}
