// Names that become paths, and whatever is printed of names, files, titles and origins.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "media/png.h"
#include "program.h"

namespace obscura::app {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kSpace = R"(duration = 0.1
[film]
size = [96, 54]
fps = 30
[[ball]]
position = [0, 1, 0]
radius = 0.2
)";

const std::string kPlane = R"(duration = 0.1
[film]
size = [96, 54]
fps = 30
[room]
size = [4, 2.25]
[[ball]]
name = "ball"
radius = 0.2
position = [1, 1]
[golden]
at = [0]
size = [96, 54]
)";

// no byte but line feeds that a terminal would act on, as bytes or as UTF-8
bool clean(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if ((c < 0x20 && c != '\n') || c == 0x7F || c == 0xFF) return false;
    if (c == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0) return false;
    if (text.compare(i, 3, "\u202E") == 0) return false;
  }
  return true;
}

class Names : public Program {
 protected:
  std::vector<std::string> files() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      if (entry.is_regular_file() && entry.path().filename() != ".stderr")
        all.push_back(fs::relative(entry.path(), folder_).string());
    return all;
  }
};

TEST_F(Names, OfCamerasStayInTheFolderTheyAreFor) {
  fs::create_directories(path("a/b"));
  for (const std::string name : {"../../evil", "/tmp/obscura-evil", "a/b", "..", ".hidden", "-rf", "",
                                 "a\\\\b", "a\\u001b[2Jb", "a%d", "{frame}", "a ", "a\\u202Eb", "a\\nb"}) {
    scene(kSpace + "[[camera]]\nname = \"" + name + "\"\n[[camera]]\nname = \"other\"\n", "a/b/s.toml");
    const Outcome run = shell("cd a/b && " OBSCURA_BINARY " render s.toml -o '{camera}.mp4' --progress none");
    EXPECT_EQ(run.exit, 3) << name;
    EXPECT_THAT(run.err,
                HasSubstr("s.toml:9:8: 'name': expected a string that may be part of a file's name"));
    EXPECT_TRUE(clean(run.err + run.out)) << name;
    EXPECT_THAT(files(), testing::ElementsAre("a/b/s.toml")) << name;
  }
  EXPECT_FALSE(fs::exists("/tmp/obscura-evil.mp4"));
}

TEST_F(Names, OfCamerasMayBeWords) {
  scene(kSpace + "[[camera]]\nname = \"from above, 30°\"\n[[camera]]\nname = \"Überblick\"\n");
  const Outcome run = obscura("render scene.toml -o 'out/{camera}.mp4' --progress none");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(files(),
              testing::UnorderedElementsAre("scene.toml", "out/from above, 30°.mp4", "out/Überblick.mp4"));
}

TEST_F(Names, ACameraWithoutOneIsNoFile) {
  scene(kPlane);
  const Outcome run = obscura("render scene.toml -o '{camera}.mp4'");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("-o {camera}.mp4: the scene's camera has no name"));
}

// a scene whose name reads as a pattern is filmed under it all the same
TEST_F(Names, OfScenesAreNoPatterns) {
  for (const std::string name : {"50%", "a%04d", "a{frame}", "{camera}"}) {
    scene(kPlane, name + ".toml");
    Outcome run = obscura("render '" + name + ".toml' --progress none");
    EXPECT_EQ(run.exit, 0) << run.err;
    EXPECT_TRUE(fs::exists(path("render_out/" + name + ".mp4"))) << name;
    run = obscura("render '" + name + ".toml' --at 0 --progress none");
    EXPECT_EQ(run.exit, 0) << run.err;
    EXPECT_TRUE(fs::exists(path("render_out/" + name + ".png"))) << name;
  }
}

TEST_F(Names, OfNewScenesAreThoseThatFilesHave) {
  for (const char* name : {"''", "a/", "/", ".toml", "a/.toml", ".", "..", "$'a\\nb'", "$'\\xff'", "'a|b'"}) {
    const Outcome run = shell("bash -c " + std::string("\"") + OBSCURA_BINARY " new " + name + "\"");
    EXPECT_EQ(run.exit, 2) << name << run.err;
    EXPECT_THAT(run.err,
                testing::AnyOf(HasSubstr("new needs a name"), HasSubstr("expected a string that may")));
    EXPECT_TRUE(clean(run.err));
  }
  EXPECT_TRUE(files().empty());
  EXPECT_EQ(obscura("new 'lectures/my first room'").exit, 0);
  EXPECT_EQ(obscura("check 'lectures/my first room.toml'").exit, 0);
}

// escape sequences in the name of a file, in what a PNG says of itself, in a title
TEST_F(Names, ArePrintedWithoutWhatATerminalActsOn) {
  const std::string odd =
                        "a\x1b[31m\x7f\xc2\x9b"
                        "2J\xff\u202E\nb.toml",
                    file = "'" + odd + "'";
  scene("title = \"\\u001b[2J\\u009b\"\n" + kPlane, odd);
  for (const std::string& arguments : {"check " + file,
                                       "render " + file + " -o a.mp4",
                                       "render " + file + " --at 0 -o a.png",
                                       "states " + file + " --at 0",
                                       "states " + file + " --at 0 --format csv",
                                       "export " + file,
                                       "figure " + file + " -o a.svg",
                                       "golden " + file,
                                       "golden " + file + " --update",
                                       "golden " + file,
                                       "sweep " + file + " --vary seed=1:2 --measure hash@end",
                                       std::string("verify a.png a.mp4"),
                                       "check no" + file,
                                       "render " + file + " -o a.mp4 --progress json",
                                       "new " + file,
                                       "render --" + file,
                                       file,
                                       "render " + file + " --set " + file,
                                       "compare " + file + " a.png",
                                       "join " + file}) {
    const Outcome run = obscura(arguments);
    EXPECT_TRUE(clean(run.out + run.err)) << arguments << "\n" << run.out << run.err;
    EXPECT_LT(run.exit, 128) << arguments << run.err;
  }
  EXPECT_EQ(contents(path("a.svg")).find('\x1b'), std::string::npos);
}

TEST_F(Names, OfAPngsOriginArePrintedClean) {
  scene(kPlane);
  ASSERT_EQ(obscura("render scene.toml --at 0 -o a.png").exit, 0);
  media::Png png = media::read_png(path("a.png"));
  auto json = nlohmann::json::parse(png.tags.at("obscura"));
  const std::string bad = "../\x1b]0;x\x07\xc2\x9b";
  json["scene"]["file"] = bad + ".toml", json["theme"] = bad, json["camera"] = bad, json["state"] = bad;
  json["gl"]["version"] = bad, json["version"] = bad, json["trajectory"] = "";
  json["scene"]["text"] = kPlane + "# " + bad, json["scene"]["set"] = {"seed=" + bad};
  png.tags["obscura"] = json.dump();
  media::write_png(path("b.png"), png.image, {.tags = png.tags});
  json["trajectory"] = bad;
  png.tags["obscura"] = json.dump();
  media::write_png(path("c.png"), png.image, {.tags = png.tags});
  for (const char* arguments : {"compare a.png b.png", "compare b.png a.png --format json", "verify b.png",
                                "verify c.png", "compare b.png c.png"}) {
    const Outcome run = obscura(arguments);
    EXPECT_TRUE(clean(run.out + run.err)) << arguments << "\n" << run.out << run.err;
    EXPECT_LT(run.exit, 128) << run.err;
  }
}

}  // namespace
}  // namespace obscura::app
