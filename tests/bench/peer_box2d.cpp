// The crowd filmed by hand with Box2D, OpenGL in OSMesa with 4x multisampling, and a raw pipe into ffmpeg:
// peer_box2d OUT.mp4 SECONDS. With OBSCURA_BOX2D3 it is Box2D 3, else the 2.4 of Debian.

#define GL_GLEXT_PROTOTYPES 1
#include <GL/osmesa.h>

#include <GL/glext.h>  // after what it builds on

#include <box2d/box2d.h>

#include <cmath>
#include <cstdlib>

#include "crowd.h"

namespace {

using namespace crowd;

struct Vertex {
  float x, y;
  std::uint8_t rgba[4];
};

#ifdef OBSCURA_BOX2D3
b2Vec2 placed(const b2Transform& pose, float x, float y) { return b2TransformPoint(pose, {x, y}); }
#else
b2Vec2 placed(const b2Transform& pose, float x, float y) { return b2Mul(pose, b2Vec2(x, y)); }
#endif

// Triangles in painter's order, in pixels, y up (so that the rows read back are turned over by the
// projection).
class Mesh {
 public:
  std::vector<Vertex> vertices;

  void triangle(b2Vec2 a, b2Vec2 b, b2Vec2 c, Rgb color) {
    for (const b2Vec2 p : {a, b, c})
      vertices.push_back({p.x,
                          p.y,
                          {std::uint8_t(color.r * 255 + .5), std::uint8_t(color.g * 255 + .5),
                           std::uint8_t(color.b * 255 + .5), 255}});
  }
  void quad(b2Vec2 a, b2Vec2 b, b2Vec2 c, b2Vec2 d, Rgb color) {
    triangle(a, b, c, color);
    triangle(a, c, d, color);
  }
  void line(b2Vec2 a, b2Vec2 b, float width, Rgb color) {
    const b2Vec2 along = b - a;
    const float half = 0.5f * width / std::hypot(along.x, along.y);
    const b2Vec2 side = {-half * along.y, half * along.x};
    quad(a + side, b + side, b - side, a - side, color);
  }
  void disc(b2Vec2 center, float radius, Rgb color) {
    constexpr int kSides = 24;
    for (int i = 0; i < kSides; ++i) {
      const float a = float(2 * M_PI * i / kSides), b = float(2 * M_PI * (i + 1) / kSides);
      triangle(center, center + b2Vec2{radius * std::cos(a), radius * std::sin(a)},
               center + b2Vec2{radius * std::cos(b), radius * std::sin(b)}, color);
    }
  }
  void box(const b2Transform& pose, float half_width, float half_height, Rgb color) {
    quad(placed(pose, -half_width, -half_height), placed(pose, half_width, -half_height),
         placed(pose, half_width, half_height), placed(pose, -half_width, half_height), color);
  }
};

b2Vec2 pixel(b2Vec2 p) { return {float(kLeft + p.x * kScale), float(kTop + (kRoomHeight - p.y) * kScale)}; }

Mesh still_picture() {
  Mesh mesh;
  const float w = float(kRoomWidth * kScale), h = float(kRoomHeight * kScale), x0 = kLeft, y0 = kTop;
  const Rgb grey{.5, .52, .54}, white{1, 1, 1}, ink{.122, .137, .157};
  for (float x = -22; x < w + 22; x += 14 * 1.414f) {
    mesh.line({x0 + x, y0}, {x0 + x + 22, y0 - 22}, 1.6f, grey);
    mesh.line({x0 + x - 22, y0 + h + 22}, {x0 + x, y0 + h}, 1.6f, grey);
  }
  for (float y = 0; y < h + 22; y += 14 * 1.414f) {
    mesh.line({x0 - 22, y0 + y}, {x0, y0 + y - 22}, 1.6f, grey);
    mesh.line({x0 + w, y0 + y}, {x0 + w + 22, y0 + y - 22}, 1.6f, grey);
  }
  const float o = float(kWall / 2);
  mesh.quad({x0 - o, y0 - o}, {x0 + w + o, y0 - o}, {x0 + w + o, y0 + h + o}, {x0 - o, y0 + h + o}, ink);
  mesh.quad({x0 + o, y0 + o}, {x0 + w - o, y0 + o}, {x0 + w - o, y0 + h - o}, {x0 + o, y0 + h - o}, white);
  return mesh;
}

const b2Vec2 kCorners[4] = {{0, 0},
                            {0, float(kRoomHeight)},
                            {float(kRoomWidth), float(kRoomHeight)},
                            {float(kRoomWidth), 0}};  // clockwise: the solid side is outside

// The bodies, which pass through each other, in their room.
#ifdef OBSCURA_BOX2D3

class Room {
 public:
  Room() {
    b2WorldDef def = b2DefaultWorldDef();
    def.gravity = {0, float(kGravity)};
    world_ = b2CreateWorld(&def);
    const b2BodyDef ground = b2DefaultBodyDef();
    b2ChainDef walls = b2DefaultChainDef();
    walls.points = kCorners;
    walls.count = 4;
    walls.isLoop = true;
    b2CreateChain(b2CreateBody(world_, &ground), &walls);
    shape_ = b2DefaultShapeDef();
    shape_.material.friction = 0;
    shape_.material.restitution = float(kElasticity);
    shape_.filter.groupIndex = -1;
    const b2Circle circle = {{0, 0}, float(kBallRadius)};
    for (const Start& s : balls()) b2CreateCircleShape(balls_.emplace_back(add(s)), &shape_, &circle);
    const b2Polygon rectangle = b2MakeBox(float(kBoxWidth / 2), float(kBoxHeight / 2));
    for (const Start& s : boxes()) b2CreatePolygonShape(boxes_.emplace_back(add(s)), &shape_, &rectangle);
  }
  void step() { b2World_Step(world_, 1.0f / kFps, 4); }
  b2Vec2 ball(std::size_t i) const { return b2Body_GetPosition(balls_[i]); }
  // turned over, as rows of pixels are
  b2Transform box(std::size_t i) const {
    return {b2Body_GetPosition(boxes_[i]), b2InvertRot(b2Body_GetRotation(boxes_[i]))};
  }

 private:
  b2BodyId add(const Start& s) const {
    b2BodyDef def = b2DefaultBodyDef();
    def.type = b2_dynamicBody;
    def.position = {float(s.x), float(s.y)};
    def.linearVelocity = {float(s.vx), float(s.vy)};
    def.angularVelocity = float(s.spin);
    return b2CreateBody(world_, &def);
  }

  b2WorldId world_;
  b2ShapeDef shape_;
  std::vector<b2BodyId> balls_, boxes_;
};

#else

class Room {
 public:
  Room() {
    b2BodyDef ground;
    b2ChainShape walls;
    walls.CreateLoop(kCorners, 4);
    world_.CreateBody(&ground)->CreateFixture(&walls, 0);
    b2CircleShape circle;
    circle.m_radius = float(kBallRadius);
    for (const Start& s : balls()) balls_.push_back(add(s, circle));
    b2PolygonShape rectangle;
    rectangle.SetAsBox(float(kBoxWidth / 2), float(kBoxHeight / 2));
    for (const Start& s : boxes()) boxes_.push_back(add(s, rectangle));
  }
  void step() { world_.Step(1.0f / kFps, 8, 3); }
  b2Vec2 ball(std::size_t i) const { return balls_[i]->GetPosition(); }
  // turned over, as rows of pixels are
  b2Transform box(std::size_t i) const { return {boxes_[i]->GetPosition(), b2Rot(-boxes_[i]->GetAngle())}; }

 private:
  b2Body* add(const Start& s, const b2Shape& shape) {
    b2BodyDef def;
    def.type = b2_dynamicBody;
    def.position.Set(float(s.x), float(s.y));
    def.linearVelocity.Set(float(s.vx), float(s.vy));
    def.angularVelocity = float(s.spin);
    b2Body* body = world_.CreateBody(&def);
    b2FixtureDef fixture;
    fixture.shape = &shape;
    fixture.density = 1;
    fixture.friction = 0;
    fixture.restitution = float(kElasticity);
    fixture.filter.groupIndex = -1;
    body->CreateFixture(&fixture);
    return body;
  }

  b2World world_{{0, float(kGravity)}};
  std::vector<b2Body*> balls_, boxes_;
};

#endif

// The GL functions used, looked up once.
#define FUNCTIONS(F)                                                                                        \
  F(PFNGLCREATESHADERPROC, glCreateShader)                                                                  \
  F(PFNGLSHADERSOURCEPROC, glShaderSource)                                                                  \
  F(PFNGLCOMPILESHADERPROC, glCompileShader)                                                                \
  F(PFNGLCREATEPROGRAMPROC, glCreateProgram)                                                                \
  F(PFNGLATTACHSHADERPROC, glAttachShader)                                                                  \
  F(PFNGLLINKPROGRAMPROC, glLinkProgram)                                                                    \
  F(PFNGLUSEPROGRAMPROC, glUseProgram)                                                                      \
  F(PFNGLGENVERTEXARRAYSPROC, glGenVertexArrays)                                                            \
  F(PFNGLBINDVERTEXARRAYPROC, glBindVertexArray)                                                            \
  F(PFNGLGENBUFFERSPROC, glGenBuffers) F(PFNGLBINDBUFFERPROC, glBindBuffer)                                 \
      F(PFNGLBUFFERDATAPROC, glBufferData) F(PFNGLVERTEXATTRIBPOINTERPROC, glVertexAttribPointer)           \
          F(PFNGLENABLEVERTEXATTRIBARRAYPROC, glEnableVertexAttribArray)                                    \
              F(PFNGLGENFRAMEBUFFERSPROC, glGenFramebuffers) F(PFNGLBINDFRAMEBUFFERPROC, glBindFramebuffer) \
                  F(PFNGLGENRENDERBUFFERSPROC, glGenRenderbuffers)                                          \
                      F(PFNGLBINDRENDERBUFFERPROC, glBindRenderbuffer)                                      \
                          F(PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC, glRenderbufferStorageMultisample)      \
                              F(PFNGLFRAMEBUFFERRENDERBUFFERPROC, glFramebufferRenderbuffer)                \
                                  F(PFNGLBLITFRAMEBUFFERPROC, glBlitFramebuffer)
#define DECLARE(type, name) type name##_;
FUNCTIONS(DECLARE)
#undef DECLARE

class Screen {
 public:
  Screen() {
    const int attributes[] = {OSMESA_FORMAT,
                              OSMESA_RGBA,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              3,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              3,
                              0};
    OSMesaMakeCurrent(OSMesaCreateContextAttribs(attributes, nullptr), window_.data(), GL_UNSIGNED_BYTE,
                      kWidth, kHeight);
#define LOAD(type, name) name##_ = reinterpret_cast<type>(OSMesaGetProcAddress(#name));
    FUNCTIONS(LOAD)
#undef LOAD
    const char* vertex =
        "#version 330\nlayout(location=0) in vec2 p; layout(location=1) in vec4 c; out vec4 color;\n"
        "void main() { color = c; gl_Position = vec4(p.x / 960.0 - 1.0, p.y / 540.0 - 1.0, 0, 1); }";
    const char* fragment = "#version 330\nin vec4 color; out vec4 result; void main() { result = color; }";
    const GLuint program = glCreateProgram_();
    for (const auto& [kind, text] :
         {std::pair{GL_VERTEX_SHADER, vertex}, std::pair{GL_FRAGMENT_SHADER, fragment}}) {
      const GLuint shader = glCreateShader_(GLenum(kind));
      glShaderSource_(shader, 1, &text, nullptr);
      glCompileShader_(shader);
      glAttachShader_(program, shader);
    }
    glLinkProgram_(program);
    glUseProgram_(program);
    GLuint array, buffer, samples;
    glGenVertexArrays_(1, &array);
    glBindVertexArray_(array);
    glGenBuffers_(1, &buffer);
    glBindBuffer_(GL_ARRAY_BUFFER, buffer);
    glVertexAttribPointer_(0, 2, GL_FLOAT, GL_FALSE, sizeof(Vertex), nullptr);
    glVertexAttribPointer_(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(Vertex), reinterpret_cast<void*>(8));
    glEnableVertexAttribArray_(0);
    glEnableVertexAttribArray_(1);
    glGenFramebuffers_(1, &multisampled_);
    glBindFramebuffer_(GL_FRAMEBUFFER, multisampled_);
    glGenRenderbuffers_(1, &samples);
    glBindRenderbuffer_(GL_RENDERBUFFER, samples);
    glRenderbufferStorageMultisample_(GL_RENDERBUFFER, 4, GL_RGBA8, kWidth, kHeight);
    glFramebufferRenderbuffer_(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, samples);
    glViewport(0, 0, kWidth, kHeight);
    glClearColor(1, 1, 1, 1);
  }

  // Row 0 is the top, for y runs down in the mesh.
  const std::uint8_t* draw(const Mesh& mesh) {
    glBindFramebuffer_(GL_FRAMEBUFFER, multisampled_);
    glClear(GL_COLOR_BUFFER_BIT);
    glBufferData_(GL_ARRAY_BUFFER, GLsizeiptr(mesh.vertices.size() * sizeof(Vertex)), mesh.vertices.data(),
                  GL_STREAM_DRAW);
    glDrawArrays(GL_TRIANGLES, 0, GLsizei(mesh.vertices.size()));
    glBindFramebuffer_(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer_(0, 0, kWidth, kHeight, 0, 0, kWidth, kHeight, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer_(GL_READ_FRAMEBUFFER, 0);
    glReadPixels(0, 0, kWidth, kHeight, GL_RGBA, GL_UNSIGNED_BYTE, pixels_.data());
    return pixels_.data();
  }

 private:
  std::vector<std::uint8_t> window_ = std::vector<std::uint8_t>(4 * kWidth * kHeight), pixels_ = window_;
  GLuint multisampled_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const int frames = int(std::atof(argv[2]) * kFps);
  std::FILE* out = film(argv[1], "rgba");
  if (!out) return 4;

  Room room;
  const auto ball_starts = balls(), box_starts = boxes();
  Screen screen;
  const Mesh still = still_picture();
  for (int frame = 0; frame < frames; ++frame) {
    Mesh mesh = still;
    for (std::size_t i = 0; i < ball_starts.size(); ++i) {
      const b2Vec2 center = pixel(room.ball(i));
      mesh.disc(center, float(kBallRadius * kScale), outline(ball_starts[i].color));
      mesh.disc(center, float(kBallRadius * kScale - kOutline), fill(ball_starts[i].color));
    }
    for (std::size_t i = 0; i < box_starts.size(); ++i) {
      b2Transform pose = room.box(i);
      pose.p = pixel(pose.p);
      const float w = float(kBoxWidth * kScale / 2), h = float(kBoxHeight * kScale / 2),
                  line = float(kOutline);
      const Rgb edge = outline(box_starts[i].color);
      mesh.box(pose, w, h, edge);
      mesh.box(pose, w - line, h - line, fill(box_starts[i].color));
      mesh.line(placed(pose, -line / 2, 0), placed(pose, 0.6f * h, 0), line, edge);
      mesh.line(pose.p, placed(pose, 0, -0.6f * h), line, edge);
    }
    std::fwrite(screen.draw(mesh), 4, std::size_t(kWidth) * kHeight, out);
    room.step();
  }
  return argv[1] == std::string("-") ? std::fclose(out) != 0 : pclose(out) != 0;
}
