// Three lines of obscura's in a program with Box2D v3: a ball and a leaning crate fall onto a slope.
#include "obscura_box2d.h"

static b2BodyId body(b2WorldId world, const char* name, b2Vec2 position, float angle) {
  b2BodyDef def = b2DefaultBodyDef();
  def.type = b2_dynamicBody, def.name = name, def.position = position, def.rotation = b2MakeRot(angle);
  return b2CreateBody(world, &def);
}

int main(void) {
  b2WorldDef world_def = b2DefaultWorldDef();
  world_def.gravity = (b2Vec2){0, -9.81f};
  b2WorldId world = b2CreateWorld(&world_def);
  b2ShapeDef stuff = b2DefaultShapeDef();
  stuff.material.friction = 0.6f, stuff.material.restitution = 0.5f;

  b2BodyDef still = b2DefaultBodyDef();
  still.name = "slope";
  b2Capsule slope = {{-2, 0.4f}, {3, 0}, 0.05f};
  b2CreateCapsuleShape(b2CreateBody(world, &still), &stuff, &slope);
  b2Circle ball = {{0, 0}, 0.2f};
  b2CreateCircleShape(body(world, "ball", (b2Vec2){0, 2}, 0), &stuff, &ball);
  b2Polygon crate = b2MakeBox(0.3f, 0.2f);
  b2CreatePolygonShape(body(world, "crate", (b2Vec2){0.9f, 1.4f}, 0.3f), &stuff, &crate);

  obscura_begin(world, "run", 60);
  for (int step = 0; step < 91; ++step) {
    obscura_frame();
    b2World_Step(world, 1 / 60.f, 4);
  }
  b2DestroyWorld(world);
}
