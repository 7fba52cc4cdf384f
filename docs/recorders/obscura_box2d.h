// Records a simulation by Box2D v3 for obscura: a table of its states, and a scene that shows them.
//
//     #include "obscura_box2d.h"                  in one file of the program
//     obscura_begin(world, "run", 60);            writes run.csv, and run.toml where there is none
//     obscura_frame();                            before each b2World_Step, 60 of them a second
#pragma once
#include <box2d/box2d.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
enum { kMostBodies = 4096, kMostShapes = 64 };
static const double kPi = 3.14159265358979323846;
typedef struct ObscuraBody {
  b2BodyId id;
  char name[40];
  b2Vec2 middle;                         // of its shapes, in its frame: obscura's centre of mass
  double reach, x, y, angle, vx, vy, w;  // how far they go from there, m; and its motion
} ObscuraBody;

static struct {
  b2WorldId world;
  const char* name;  // without folders
  int rate, frames, count;
  FILE *table, *scene;
  ObscuraBody* bodies;     // those that move
  double low[2], high[2];  // where they have been
} obscura_;

static bool obscura_found(b2ShapeId shape, void* unused) {
  b2BodyId id = ((void)unused, b2Shape_GetBody(shape));
  for (int i = 0; i < obscura_.count; ++i)
    if (B2_ID_EQUALS(obscura_.bodies[i].id, id)) return true;
  if (obscura_.count < kMostBodies) obscura_.bodies[obscura_.count++].id = id;
  return true;
}

// Writes a shape into the scene, in its body's frame. Returns its area, and its middle in (x, y).
static double obscura_shape(b2ShapeId id, double* x, double* y) {
  b2ShapeType type = b2Shape_GetType(id);
  if (type == b2_polygonShape) {
    b2Polygon it = b2Shape_GetPolygon(id);
    for (int i = 0; i < it.count; ++i)
      fprintf(obscura_.scene, "%s[%.9g, %.9g]", i ? ", " : "  { points = [", it.vertices[i].x, it.vertices[i].y);
    fprintf(obscura_.scene, "] },\n");
    it.radius = 0;
    b2MassData mass = b2ComputePolygonMass(&it, 1);
    *x = mass.center.x, *y = mass.center.y;
    return mass.mass;
  }
  // a disc, or two with a box between them; a segment has no thickness of its own
  b2Segment line = {{0, 0}, {0, 0}};
  if (type == b2_segmentShape) line = b2Shape_GetSegment(id);
  if (type == b2_chainSegmentShape) line = b2Shape_GetChainSegment(id).segment;
  b2Capsule it = {line.point1, line.point2, 0.01f};
  if (type == b2_capsuleShape) it = b2Shape_GetCapsule(id);
  if (type == b2_circleShape)
    it.center1 = it.center2 = b2Shape_GetCircle(id).center, it.radius = b2Shape_GetCircle(id).radius;
  b2Vec2 a = it.center1, b = it.center2;
  double r = it.radius, dx = b.x - a.x, dy = b.y - a.y, length = hypot(dx, dy);
  *x = a.x + dx / 2, *y = a.y + dy / 2;
  for (int end = length > 0 ? -1 : 1; end <= 1; end += 2)
    fprintf(obscura_.scene, "  { radius = %.9g, position = [%.9g, %.9g] },\n", r, *x + end * dx / 2, *y + end * dy / 2);
  if (length == 0) return kPi * r * r;
  fprintf(obscura_.scene, "  { size = [%.9g, %.9g], position = [%.9g, %.9g], angle = %.9g },\n", length, 2 * r, *x, *y,
          atan2(dy, dx) * 180 / kPi);
  return 2 * r * length + 2 * kPi * r * r;
}

static void obscura_look(ObscuraBody* it) {
  if (!b2Body_IsValid(it->id)) return;  // destroyed: it stays where it was
  b2Rot q = b2Body_GetRotation(it->id);
  b2Vec2 v = b2Body_GetLocalPointVelocity(it->id, it->middle);
  it->x = b2Body_GetPosition(it->id).x + (double)q.c * it->middle.x - (double)q.s * it->middle.y;
  it->y = b2Body_GetPosition(it->id).y + (double)q.s * it->middle.x + (double)q.c * it->middle.y;
  it->angle += remainder(atan2(q.s, q.c) - it->angle, 2 * kPi);  // counted on, not wrapped
  it->vx = v.x, it->vy = v.y, it->w = b2Body_GetAngularVelocity(it->id);
}

// what is in the world at the first frame is what is recorded
static void obscura_find(void) {
  b2AABB all = {{-1e5f, -1e5f}, {1e5f, 1e5f}};
  obscura_.bodies = (ObscuraBody*)calloc(kMostBodies, sizeof(ObscuraBody));
#ifdef B2_NULL_ID  // after 3.1 queries have an origin
  b2World_OverlapAABB(obscura_.world, b2Pos_zero, all, b2DefaultQueryFilter(), obscura_found, NULL);
#else
  b2World_OverlapAABB(obscura_.world, all, b2DefaultQueryFilter(), obscura_found, NULL);
#endif
  int moving = 0;
  for (int i = 0; i < obscura_.count; ++i) {
    ObscuraBody* it = &obscura_.bodies[i];
    const char* name = b2Body_GetName(it->id);
    if (name && isalpha((unsigned char)*name)) snprintf(it->name, sizeof it->name, "%s", name);
    else snprintf(it->name, sizeof it->name, "body%d", i);
    for (char* c = it->name; *c; ++c) *c = isalnum((unsigned char)*c) ? *c : '_';
    fprintf(obscura_.scene, "\n[[body]]\nname = \"%s\"\nshapes = [\n", it->name);
    b2ShapeId shapes[kMostShapes];
    double sum = 0, x = 0, y = 0, cx = 0, cy = 0;
    for (int k = 0, n = b2Body_GetShapes(it->id, shapes, kMostShapes); k < n; ++k) {
      double area = obscura_shape(shapes[k], &x, &y);
      sum += area, cx += (x - cx) * area / sum, cy += (y - cy) * area / sum;
    }
    it->middle.x = (float)cx, it->middle.y = (float)cy, obscura_look(it);
    it->reach = b2Length(b2AABB_Extents(b2Body_ComputeAABB(it->id)));
    fprintf(obscura_.scene, "]\nposition = [%.9g, %.9g]\nangle = %.9g\n", b2Body_GetPosition(it->id).x,
            b2Body_GetPosition(it->id).y, it->angle * 180 / kPi);
    if (b2Body_GetType(it->id) != b2_staticBody) obscura_.bodies[moving++] = *it;
    else fprintf(obscura_.scene, "fixed = true\ncolor = \"grey\"\n");
  }
  const char* columns[] = {"position.x", "position.y", "angle", "velocity.x", "velocity.y", "spin"};
  obscura_.count = moving;
  fprintf(obscura_.table, "time");
  for (ObscuraBody* it = obscura_.bodies; it < obscura_.bodies + moving; ++it)
    for (int k = 0; k < 6; ++k) fprintf(obscura_.table, ",%s.%s", it->name, columns[k]);
}

static void obscura_end(void) {
  double w = obscura_.high[0] - obscura_.low[0], h = obscura_.high[1] - obscura_.low[1], margin = 0.1 * fmax(w, h);
  fprintf(obscura_.scene, "\n[room]\nsize = [%.9g, %.9g]\ncorner = [%.9g, %.9g]\nwalls = \"none\"\n", w + 2 * margin,
          h + 2 * margin, obscura_.low[0] - margin, obscura_.low[1] - margin);
  fprintf(obscura_.scene, "\n[golden]\nstates = \"%s.csv\"\nat = [\"%d/%d\", \"%d/%d\"]\n", obscura_.name,
          (obscura_.frames - 1) / 2, obscura_.rate, obscura_.frames - 1, obscura_.rate);
  fprintf(obscura_.table, "\n"), fclose(obscura_.table), fclose(obscura_.scene);
}

static void obscura_begin(b2WorldId world, const char* name, int rate) {
  char file[240];
  snprintf(file, sizeof file, "%s.csv", name), obscura_.table = fopen(file, "w");
  snprintf(file, sizeof file, "%s.toml", name), obscura_.scene = fopen(file, "wx");
  if (!obscura_.scene) obscura_.scene = fopen("/dev/null", "w");  // a scene that is there is yours
  if (!obscura_.table || !obscura_.scene) perror(name), exit(1);
  obscura_.name = strrchr(name, '/') ? strrchr(name, '/') + 1 : name;
  fprintf(obscura_.scene, "duration = 3600  # or the table's end\n[film]\nfps = %d\n[physics]\noverlap = \"separate\"\n", rate);
  obscura_.world = world, obscura_.rate = rate, obscura_.low[0] = obscura_.low[1] = HUGE_VAL;
  obscura_.high[0] = obscura_.high[1] = -HUGE_VAL, atexit(obscura_end);
}

static void obscura_frame(void) {
  if (!obscura_.bodies) obscura_find();
  fprintf(obscura_.table, "\n%.17g", (double)obscura_.frames++ / obscura_.rate);
  for (ObscuraBody* it = obscura_.bodies; it < obscura_.bodies + obscura_.count; ++it) {
    obscura_look(it);
    fprintf(obscura_.table, ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", it->x, it->y, it->angle, it->vx, it->vy, it->w);
    for (int k = 0; k < 2; ++k) {
      obscura_.low[k] = fmin(obscura_.low[k], (k ? it->y : it->x) - it->reach);
      obscura_.high[k] = fmax(obscura_.high[k], (k ? it->y : it->x) + it->reach);
    }
  }
}
