// With ccache each file is compiled alone, and does not see what would clash without: these tests do.

#include "architecture/names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "architecture/planted.h"
#include "where.h"

namespace obscura::architecture {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class PlantedNames : public Planted {
 protected:
  Complaints clashes() const { return clashing_names(src_, compiled_apart(src_ / "CMakeLists.txt"), {src_}); }
};

TEST(EveryName, IsOfOneFile) {
  const std::filesystem::path src = std::filesystem::path(OBSCURA_SOURCE_DIR) / "src",
                              tests = std::filesystem::path(OBSCURA_SOURCE_DIR) / "tests";
  const auto apart = compiled_apart(src / "CMakeLists.txt");
  EXPECT_TRUE(apart.contains("sim/collide/narrow_phase_space.cpp"));
  EXPECT_THAT(clashing_names(src, apart, {src}), IsEmpty());
  EXPECT_THAT(clashing_names(tests, compiled_apart(tests / "CMakeLists.txt"), {tests, src}), IsEmpty());
}

TEST(EveryName, HasItsHeader) {
  const std::filesystem::path src = std::filesystem::path(OBSCURA_SOURCE_DIR) / "src",
                              tests = std::filesystem::path(OBSCURA_SOURCE_DIR) / "tests";
  EXPECT_THAT(names_without_headers(src, {src}), IsEmpty());
  EXPECT_THAT(names_without_headers(tests, {tests, src}), IsEmpty());
}

TEST_F(PlantedNames, WithoutTheirHeadersAreFound) {
  plant("app/options.h",
        "namespace obscura::app {\nvoid require(int n);\nstruct Flags { int n; };\nconstexpr int kMost = "
        "3;\n}\n");
  plant("app/through.h", "#include \"app/options.h\"\n");
  plant("app/a.cpp", "#include \"app/through.h\"\nvoid f() { require(kMost); Flags flags; }\n");
  plant("app/b.cpp",
        "void g() {\n  require(\n    kMost);\n  if (!x) return require(2);\n  const Flags flags;\n}\n");
  // a member, a name of its own, of another scope, and one that is only said to be somewhere
  plant(
      "app/c.cpp",
      "struct Flags;\nvoid h(Flags& flags) { flags.require(1); other::require(2); const auto kMost = 1; }\n");
  // that a file beside it takes from another namespace
  plant("sim/vec.h", "namespace obscura::sim {\nusing Vec3 = double;\n}\n");
  plant("app/d.cpp",
        "#include \"sim/vec.h\"\nnamespace obscura::app {\nusing sim::Vec3;\nVec3 zero() { return 0; }\n}\n");
  plant("app/e.cpp",
        "#include \"sim/vec.h\"\nnamespace obscura::app {\nvoid take(sim::Vec3) {}\nvoid one() { Vec3 x = 1; "
        "}\n}\n");
  EXPECT_THAT(names_without_headers(src_, {src_}),
              ElementsAre("app/b.cpp:5: Flags without options.h", "app/b.cpp:3: kMost without options.h",
                          "app/b.cpp:2: require without options.h", "app/e.cpp:4: Vec3 without using"));
}

TEST_F(PlantedNames, OfTwoFilesAreFoundWhateverTheyName) {
  plant("sim/a.cpp", R"(namespace obscura::sim {
namespace {
constexpr double kOne = 1'000, kTwo = two<1, 2>('"', "}");  // { "
struct Body : Base<2> { int kept; };
enum class Way { in, out };
using Vec = Eigen::Vector2d;
template <int D> std::map<int, double> sums(const World<D>& world, int first = f(1, 2)) { return {}; }
Body::Body(int a) : kept{a} {}
std::function<void(int)> made() { return {}; }
const std::array<int, 2> kPlaces{1, 2};
/* constexpr double kFour = 4; */
#define TWICE(x) \
  struct Twice { x }
const char* const kScene = R"toml(
struct Scene { int n; };
)toml";
TEST(Suite, Name) { int kept = 1; }
MATCHER_P(Near, what, "") { return true; }
}
static int counted() { return 1; }
}
)");
  plant("sim/b.cpp", R"(namespace obscura::sim { namespace {
const int kTwo = 3;
class Body { int x; };
enum Way : int { left };
using Vec = Eigen::Vector3d;
template <int D>
double sums(const World<D>& w, int n) { return 0; }
int made() { return 1; }
int kPlaces[2] = {1, 2};
constexpr const char* kScene = "";
TEST_F(Suite, Name) {}
MATCHER_P2(Near, what, how, "") { return true; }
}
int counted() { return 2; }
}
)");
  EXPECT_THAT(
      clashes(),
      ElementsAre("sim/b.cpp:2: kTwo is in a.cpp:3 too", "sim/b.cpp:3: Body is in a.cpp:4 too",
                  "sim/b.cpp:4: Way is in a.cpp:5 too", "sim/b.cpp:5: Vec is in a.cpp:6 too",
                  "sim/b.cpp:7: sums is in a.cpp:7 too", "sim/b.cpp:8: made is in a.cpp:9 too",
                  "sim/b.cpp:9: kPlaces is in a.cpp:10 too", "sim/b.cpp:10: kScene is in a.cpp:14 too",
                  "sim/b.cpp:11: Suite.Name is in a.cpp:17 too", "sim/b.cpp:12: Near is in a.cpp:18 too",
                  "sim/b.cpp:14: counted is in a.cpp:20 too"));
}

TEST_F(PlantedNames, OfTwoFoldersAreFoundWhereARoomIsCompiledAsOne) {
  const std::string a = "namespace obscura { namespace { constexpr int kOne = 1; } }\n";
  for (const char* file :
       {"app/film/a.cpp", "app/study/b.cpp", "draw/plane/a.cpp", "draw/space/b.cpp", "sim/force/a.cpp",
        "sim/math/b.cpp", "sim/solve/cone/a.cpp", "sim/solve/exact/b.cpp"})
    plant(file, a);
  EXPECT_THAT(clashes(), ElementsAre("app/study/b.cpp:1: kOne is in a.cpp:1 too",
                                     "sim/math/b.cpp:1: kOne is in a.cpp:1 too"));
}

TEST_F(PlantedNames, ThatHideAHeadersAreFound) {
  plant("sim/room.h",
        "#pragma once\n#include \"sim/table.h\"\nnamespace obscura::sim {\nenum class Mode { held };\n}\n");
  plant("sim/table.h",
        "namespace obscura {\ndouble of_words(const std::vector<std::string>& words);\nint rows(const Table& "
        "t);\n}\n");
  plant("sim/a.cpp", "#include \"sim/room.h\"\n");
  plant("sim/b.cpp",
        "namespace obscura::sim {\nnamespace {\nstruct Mode { int n; };\n"
        "double of_words(const Drop& drop) { return 0; }\nint rows(int) { return 1; }\n}\n}\n");
  EXPECT_THAT(clashes(),
              ElementsAre("sim/b.cpp:3: Mode is in room.h:4 too", "sim/b.cpp:4: of_words is in table.h:2 too",
                          "sim/b.cpp:5: rows is in table.h:3 too"));
}

TEST_F(PlantedNames, ThatDoNotMeetAreNot) {
  plant("sim/room.h", "namespace obscura::sim {\nint rows(const Table& table);\nstruct Forward;\n}\n");
  const std::string a = R"(#include "sim/room.h"
namespace obscura::sim {
struct Forward;
using std::sort;
namespace {
using Json = nlohmann::json;
int rows(const World& world) { struct Local {} one; return 1; }
double length(const Vec2& x) { return 1; }
bool operator==(const A& a, const A& b) { return true; }
}
int Body::mass() const { return 1; }
}
)";
  plant("sim/a.cpp", a);
  plant("sim/b.cpp", R"(namespace obscura::sim { namespace {
using Json = nlohmann::json;
double length(const Vec3& x) { struct Local {} one; return 1; }
bool operator==(const B& a, const B& b) { return true; }
}
int Door::mass() const { return 1; }
}
)");
  // another namespace, another folder, a file compiled alone, and folders with rules of their own
  plant("sim/c.cpp",
        "namespace obscura::draw { namespace { double length(const Vec2& x) { return 1; } } }\n");
  plant("draw/a.cpp", a);
  plant("sim/a_space.cpp", a);
  plant("bench/a.cpp", a);
  plant("bench/b.cpp", a);
  plant("bench/CMakeLists.txt", "");
  plant("CMakeLists.txt",
        "set_source_files_properties(${CMAKE_CURRENT_SOURCE_DIR}/sim/a_space.cpp\n"
        "                            PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)\n");
  EXPECT_THAT(clashes(), IsEmpty());
}

}  // namespace
}  // namespace obscura::architecture
