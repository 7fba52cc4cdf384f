// Linking does not see a header include: these tests do. The picture is in docs/design.md.

#include "architecture/arrows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "architecture/planted.h"
#include "where.h"

namespace obscura::architecture {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const std::filesystem::path kTop = OBSCURA_SOURCE_DIR;

TEST(Arrows, EveryIncludeFollowsThem) { EXPECT_THAT(wrong_includes(kTop / "src"), IsEmpty()); }

TEST(Arrows, EveryLinkFollowsThem) { EXPECT_THAT(wrong_links(kTop / "src" / "CMakeLists.txt"), IsEmpty()); }

TEST(Headers, EachFileIncludesThoseThatOnlySomeVersionsOfALibraryIncludeForIt) {
  EXPECT_THAT(missing_includes(kTop / "src"), IsEmpty());
  EXPECT_THAT(missing_includes(kTop / "tests"), IsEmpty());
}

TEST_F(Planted, ANameWithoutItsHeaderIsFound) {
  const std::string join = "fmt::join(words, \", \");\n";
  plant("app/rows.cpp", "#include <fmt/format.h>\n" + join);
  plant("app/table.cpp", "#include <fmt/ranges.h>\n" + join);
  const std::string sort = "sort(begin, end);\n";
  plant("sim/math/order.h", "const char* word = \"sort\";\nstd::" + sort);
  EXPECT_THAT(missing_includes(src_), ElementsAre("app/rows.cpp:2: fmt::join( without <fmt/ranges.h>",
                                                  testing::StartsWith("sim/math/order.h:2: ")));
}

TEST_F(Planted, AnIncludeAgainstAnArrowIsFound) {
  plant("sim/step/step.cpp",
        "#include \"sim/step/step.h\"\n#include <cmath>\n  #  include \"draw/list.h\"\n");
  plant("draw/page/list.h", "#include \"sim/model/snapshot.h\"\n#include \"media/image.h\"\n");
  EXPECT_THAT(wrong_includes(src_), ElementsAre("draw/page/list.h:2: draw may not include media/image.h",
                                                "sim/step/step.cpp:3: sim may not include draw/list.h"));
}

TEST_F(Planted, AnInterfaceThatShowsWhatIsBelowItAndWhoIncludesItFromBelowAreFound) {
  plant("obscura/obscura.h", "#include <vector>\n#include \"scene/scene.h\"\n#include <Eigen/Core>\n");
  plant("app/film/film.cpp", "#include \"obscura/obscura.h\"\n");
  plant("python/world.cpp",
        "#include <pybind11/numpy.h>\n#include \"obscura/obscura.h\"\n#include \"sim/step/run.h\"\n");
  plant("scene/text.cpp", "#include <pybind11/numpy.h>\n");
  EXPECT_THAT(wrong_includes(src_),
              ElementsAre("app/film/film.cpp:1: app may not include obscura/obscura.h",
                          "obscura/obscura.h:2: the interface of programs knows only std, not scene/scene.h",
                          "obscura/obscura.h:3: the interface of programs knows only std, not Eigen/Core",
                          "python/world.cpp:3: python may not include sim/step/run.h",
                          "scene/text.cpp:1: scene may not include <pybind11/numpy.h>"));
}

TEST_F(Planted, AnIncludeOfALaterSubRoomIsFound) {
  plant("sim/math/vec.h", "#include \"sim/model/state.h\"\n");
  plant("sim/solve/exact/cone.cpp",
        "#include \"sim/solve/exact/cone.h\"\n#include \"sim/solve/iterate/space.h\"\n");
  plant("sim/solve/iterate/space.cpp",
        "#include \"sim/solve/exact/statics.h\"\n#include \"sim/math/vec.h\"\n");
  plant("app/film/film.cpp", "#include \"app/console/exit.h\"\n#include \"app/commands/render.h\"\n");
  EXPECT_THAT(
      wrong_includes(src_),
      ElementsAre("app/film/film.cpp:2: app/film may not include app/commands/render.h",
                  "sim/math/vec.h:1: sim/math may not include sim/model/state.h",
                  "sim/solve/exact/cone.cpp:2: sim/solve/exact may not include sim/solve/iterate/space.h"));
}

TEST_F(Planted, AFolderThatIsNoSubRoomAndAFileOutsideAllAreFound) {
  plant("app/main.cpp", "#include \"app/console/commands.h\"\n");
  plant("sim/joints/hinge.h", "#pragma once\n");
  plant("sim/step.cpp", "#pragma once\n");
  EXPECT_THAT(wrong_includes(src_),
              ElementsAre("sim/joints/hinge.h: sim/joints is no sub-room of the picture",
                          "sim/step.cpp: sim is no sub-room of the picture"));
}

TEST_F(Planted, ALibraryInTheWrongRoomIsFound) {
  plant("app/commands/render.cpp",
        "#include <CLI/CLI.hpp>\n#include <GL/gl.h>\n#include <libavutil/frame.h>\n");
  plant("media/png.cpp", "#include <png.h>\n#include <toml++/toml.h>\n");
  plant("sim/model/world.h", "#include <Eigen/Core>\n#include <vector>\n#include <fmt/core.h>\n");
  plant("sim/solve/solver.cpp", "#include <Eigen/Geometry>\n#include <Eigen/LU>\n");
  EXPECT_THAT(wrong_includes(src_),
              ElementsAre("app/commands/render.cpp:2: app may not include <GL/gl.h>",
                          "app/commands/render.cpp:3: app may not include <libavutil/frame.h>",
                          "media/png.cpp:2: media may not include <toml++/toml.h>",
                          "sim/model/world.h:3: sim knows only Eigen and std, not <fmt/core.h>",
                          "sim/solve/solver.cpp:2: sim factors by itself, not by <Eigen/LU>"));
}

TEST_F(Planted, AnIncludeWithoutItsRoomAndAFolderThatIsNoRoomAreFound) {
  plant("gl/renderer.cpp", "#include \"renderer.h\"\n#include \"../draw/list.h\"\n");
  plant("utils/strings.h", "#pragma once\n");
  EXPECT_THAT(wrong_includes(src_), ElementsAre("gl/renderer.cpp:1: \"renderer.h\" does not say its room",
                                                "gl/renderer.cpp:2: \"../draw/list.h\" does not say its room",
                                                "utils/strings.h: utils is no room of the picture"));
}

TEST_F(Planted, ALinkAgainstAnArrowIsFound) {
  plant("CMakeLists.txt", "obscura_room(sim)\nobscura_room(draw ROOMS sim media\n  LIBRARIES fmt::fmt)\n");
  EXPECT_THAT(wrong_links(src_ / "CMakeLists.txt"), ElementsAre("draw may not link media"));
}

}  // namespace
}  // namespace obscura::architecture
