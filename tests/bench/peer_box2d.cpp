// The crowd filmed by hand with Box2D, OpenGL in OSMesa with 4x multisampling, and a raw pipe into ffmpeg:
// peer_box2d OUT.mp4 SECONDS.

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
    b2Vec2 along = b - a;
    along.Normalize();
    const b2Vec2 side = 0.5f * width * b2Vec2(-along.y, along.x);
    quad(a + side, b + side, b - side, a - side, color);
  }
  void disc(b2Vec2 center, float radius, Rgb color) {
    constexpr int kSides = 24;
    for (int i = 0; i < kSides; ++i) {
      const float a = float(2 * M_PI * i / kSides), b = float(2 * M_PI * (i + 1) / kSides);
      triangle(center, center + radius * b2Vec2(std::cos(a), std::sin(a)),
               center + radius * b2Vec2(std::cos(b), std::sin(b)), color);
    }
  }
  void box(const b2Transform& pose, float half_width, float half_height, Rgb color) {
    quad(b2Mul(pose, b2Vec2(-half_width, -half_height)), b2Mul(pose, b2Vec2(half_width, -half_height)),
         b2Mul(pose, b2Vec2(half_width, half_height)), b2Mul(pose, b2Vec2(-half_width, half_height)), color);
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

b2Body* add(b2World& world, const Start& s, const b2Shape& shape, float density) {
  b2BodyDef def;
  def.type = b2_dynamicBody;
  def.position.Set(float(s.x), float(s.y));
  def.linearVelocity.Set(float(s.vx), float(s.vy));
  def.angularVelocity = float(s.spin);
  b2Body* body = world.CreateBody(&def);
  b2FixtureDef fixture;
  fixture.shape = &shape;
  fixture.density = density;
  fixture.friction = 0;
  fixture.restitution = float(kElasticity);
  fixture.filter.groupIndex = -1;  // bodies pass through each other
  body->CreateFixture(&fixture);
  return body;
}

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
  F(PFNGLBINDVERTEXARRAYPROC, glBindVertexArray) F(PFNGLGENBUFFERSPROC, glGenBuffers)                       \
      F(PFNGLBINDBUFFERPROC, glBindBuffer) F(PFNGLBUFFERDATAPROC, glBufferData)                             \
          F(PFNGLVERTEXATTRIBPOINTERPROC, glVertexAttribPointer) F(PFNGLENABLEVERTEXATTRIBARRAYPROC,        \
                                                                   glEnableVertexAttribArray)               \
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

  b2World world({0, float(kGravity)});
  b2BodyDef ground;
  b2ChainShape walls;  // clockwise: its solid side is outside
  const b2Vec2 corners[4] = {{0, 0}, {0, kRoomHeight}, {kRoomWidth, kRoomHeight}, {kRoomWidth, 0}};
  walls.CreateLoop(corners, 4);
  world.CreateBody(&ground)->CreateFixture(&walls, 0);
  b2CircleShape circle;
  circle.m_radius = float(kBallRadius);
  b2PolygonShape rectangle;
  rectangle.SetAsBox(float(kBoxWidth / 2), float(kBoxHeight / 2));
  const auto ball_starts = balls(), box_starts = boxes();
  std::vector<b2Body*> ball_bodies, box_bodies;
  for (const Start& s : ball_starts) ball_bodies.push_back(add(world, s, circle, 1));
  for (const Start& s : box_starts) box_bodies.push_back(add(world, s, rectangle, 1));

  Screen screen;
  const Mesh still = still_picture();
  for (int frame = 0; frame < frames; ++frame) {
    Mesh mesh = still;
    for (std::size_t i = 0; i < ball_bodies.size(); ++i) {
      const b2Vec2 center = pixel(ball_bodies[i]->GetPosition());
      mesh.disc(center, float(kBallRadius * kScale), outline(ball_starts[i].color));
      mesh.disc(center, float(kBallRadius * kScale - kOutline), fill(ball_starts[i].color));
    }
    for (std::size_t i = 0; i < box_bodies.size(); ++i) {
      const b2Transform pose(pixel(box_bodies[i]->GetPosition()), b2Rot(-box_bodies[i]->GetAngle()));
      const float w = float(kBoxWidth * kScale / 2), h = float(kBoxHeight * kScale / 2),
                  line = float(kOutline);
      const Rgb edge = outline(box_starts[i].color);
      mesh.box(pose, w, h, edge);
      mesh.box(pose, w - line, h - line, fill(box_starts[i].color));
      mesh.line(b2Mul(pose, b2Vec2(-line / 2, 0)), b2Mul(pose, b2Vec2(0.6f * h, 0)), line, edge);
      mesh.line(pose.p, b2Mul(pose, b2Vec2(0, -0.6f * h)), line, edge);
    }
    std::fwrite(screen.draw(mesh), 4, std::size_t(kWidth) * kHeight, out);
    world.Step(1.0f / kFps, 8, 3);
  }
  return argv[1] == std::string("-") ? std::fclose(out) != 0 : pclose(out) != 0;
}
