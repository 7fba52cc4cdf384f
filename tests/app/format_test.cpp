// What commands say to programs: JSON as docs/json.md has it, and workflow commands of GitHub's.

#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "app/compare/github.h"
#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using Json = nlohmann::json;

class Formats : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    ball();
  }
  void ball(const std::string& color = "green") const {
    scene(
        "duration = 2\n[room]\nsize = [4, 2.25]\n[[ball]]\nname = \"ball\"\nradius = 0.2\nposition = [1, 1]\n"
        "velocity = [1, 1]\ncolor = \"" +
        color + "\"\n[golden]\nat = [0, 0.5]\nsize = [160, 90]\n");
  }
  // what a command says, which is one object and nothing else
  Json said(const std::string& arguments, int exit) const {
    const Outcome run = obscura(arguments + " --format json");
    EXPECT_EQ(run.exit, exit) << run.out << run.err;
    EXPECT_EQ(run.err, "");
    const Json json = Json::parse(run.out, nullptr, false);
    EXPECT_FALSE(json.is_discarded()) << run.out;
    EXPECT_EQ(json.value("exit", -1), exit);
    return json;
  }
};

// the part of docs/json.md between two headings
std::string section(const std::string& name) {
  const std::string page = "\n" + contents(OBSCURA_SOURCE_DIR "/docs/json.md");
  const std::string head = page.substr(0, page.find("\n## ")), golden = page.substr(page.find("\n## golden"));
  const std::size_t from = page.find("\n## " + name), to = page.find("\n## ", from + 1);
  EXPECT_NE(from, page.npos) << name;
  // what causes and differences have is told once
  return head + page.substr(from, to - from) + golden.substr(0, golden.find("\n## ", 1));
}

// every key of an object is in its section, but those that are data
void expect_documented(const Json& json, const std::string& text) {
  if (json.is_array())
    for (const Json& each : json) expect_documented(each, text);
  if (!json.is_object()) return;
  for (const auto& [key, value] : json.items()) {
    EXPECT_THAT(text, HasSubstr("`" + key + "`"));
    if (key != "states" || value.contains("step")) expect_documented(value, text);
  }
}

TEST_F(Formats, GoldenSaysEachMoment) {
  Json json = said("golden scene.toml", 1);
  expect_documented(json, section("golden"));
  EXPECT_EQ(json["states"], (Json{{"missing", 2}}));
  EXPECT_EQ(json["moments"][1]["time"], 0.5);
  EXPECT_TRUE(std::filesystem::exists(path(json["moments"][1]["pictures"]["actual"])));
  said("golden scene.toml --update", 0);
  ball("purple");
  json = said("golden scene.toml", 1);
  expect_documented(json, section("golden"));
  const Json& moment = json["moments"][1];
  EXPECT_EQ(moment["scene"], "scene");
  EXPECT_EQ(moment["file"], "scene.toml");
  EXPECT_EQ(moment["reference"], "golden/scene-0.5.png");
  EXPECT_EQ(moment["state"], "differs");
  EXPECT_EQ(moment["good"], false);
  EXPECT_GT(moment["difference"]["pixels"], 0);
  EXPECT_EQ(moment["cause"]["kind"], "scene");
  EXPECT_TRUE(std::filesystem::exists(path(moment["pictures"]["difference"])));
  // the choice is one that --only takes
  EXPECT_EQ(said("golden scene.toml --update --only " + std::string(moment["choice"]), 0)["moments"].size(),
            1u);
  EXPECT_EQ(said("golden scene.toml", 1)["states"], (Json{{"differs", 1}, {"same", 1}}));
}

TEST_F(Formats, GoldenSaysWhatIsWrongWithAScene) {
  scene("duration = -1\n[golden]\n", "broken.toml");
  const Json json = said("golden broken.toml", 3);
  expect_documented(json, section("golden"));
  const Json& moment = json["moments"][0];
  EXPECT_EQ(moment["state"], "failed");
  EXPECT_TRUE(moment["time"].is_null());
  EXPECT_EQ(moment["errors"][0]["file"], "broken.toml");
  EXPECT_EQ(moment["errors"][0]["line"], 1);
  EXPECT_EQ(moment["errors"][0]["column"], 12);
}

TEST_F(Formats, VerifySaysEachFile) {
  ASSERT_EQ(obscura("render scene.toml --at 0 --size 160x90 -o a.png").exit, 0);
  expect_documented(said("verify a.png", 0), section("verify"));
  ball("purple");
  const Json json = said("verify a.png a.png --scene scene.toml", 1);
  expect_documented(json, section("verify"));
  ASSERT_EQ(json["files"].size(), 2u);
  EXPECT_EQ(json["files"][0]["file"], "a.png");
  EXPECT_EQ(json["files"][0]["good"], false);
  EXPECT_THAT(json["files"][0]["lines"].dump(), HasSubstr("ball.color"));
}

TEST_F(Formats, CheckSaysEachScene) {
  scene("duration = -1\n", "broken.toml");
  const Json json = said("check scene.toml broken.toml", 3);
  expect_documented(json, section("check"));
  ASSERT_EQ(json["scenes"].size(), 2u);
  const Json &good = json["scenes"][0], &broken = json["scenes"][1];
  EXPECT_EQ(good["good"], true);
  EXPECT_EQ(good["dimension"], 2);
  EXPECT_EQ(good["bodies"]["balls"], 1);
  EXPECT_EQ(good["bodies"]["boxes"], 0);
  EXPECT_EQ(good["duration"], 2.0);
  EXPECT_EQ(good["film"]["frames"], 120);
  EXPECT_GT(good["estimate"]["disk"], 0.0);
  EXPECT_EQ(broken["good"], false);
  EXPECT_EQ(broken["errors"][0]["line"], 1);
}

TEST_F(Formats, CompareSaysWhatDocumentsSay) {
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 160x90 -o a.png").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 160x90 -o b.png --set ball.velocity=[2,1]").exit, 0);
  const Json pictures = said("compare a.png b.png", 1);
  expect_documented(pictures, section("compare"));
  EXPECT_EQ(pictures["command"], "compare");
  EXPECT_EQ(pictures["cause"]["states"]["body"], "ball");
  expect_documented(said("compare a.png a.png", 0), section("compare"));
  ASSERT_EQ(obscura("states scene.toml --every 0.5 --format csv > a.csv").exit, 0);
  ASSERT_EQ(obscura("states scene.toml --every 0.5 --format csv --set ball.velocity=[2,1] > b.csv").exit, 0);
  const Json runs = said("compare a.csv b.csv", 1);
  expect_documented(runs, section("compare"));
  EXPECT_EQ(runs["part"]["body"], "ball");
}

// The lines that a runner takes as commands: as its source has it, all that begin with :: after blanks, but
// none between stop-commands and its token.
std::vector<std::string> commands(const std::string& log) {
  std::istringstream lines(log);
  std::vector<std::string> all;
  std::string token;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t start = line.find_first_not_of(" \t");
    if (start == line.npos || line.compare(start, 2, "::") != 0) continue;
    line = line.substr(start);
    if (!token.empty()) {
      if (line == "::" + token + "::") token.clear();
      continue;
    }
    if (line.starts_with("::stop-commands::"))
      token = line.substr(17);
    else
      all.push_back(line);
  }
  EXPECT_EQ(token, "") << "commands are not taken again";
  return all;
}

TEST(GitHub, CommandsAreEscaped) {
  EXPECT_EQ(github::command({.file = "a,b:c%.toml",
                             .line = 3,
                             .column = 7,
                             .title = "one: two, three\nfour",
                             .message = "100 %\n::error::x, y"}),
            "::error file=a%2Cb%3Ac%25.toml,line=3,col=7,title=one%3A two%2C three%0Afour::100 "
            "%25%0A::error::x, y\n");
  EXPECT_EQ(github::command({.level = github::Annotation::Level::warning, .message = "a\rb"}),
            "::warning::a b\n");
}

TEST(GitHub, FilesAreSeenFromTheTopOfTheCheckout) {
  const auto here = std::filesystem::current_path();
  ::setenv("GITHUB_WORKSPACE", here.parent_path().c_str(), 1);
  const std::string inside = github::command({.file = "a.toml"}),
                    outside = github::command({.file = "/a.toml"});
  ::unsetenv("GITHUB_WORKSPACE");
  EXPECT_EQ(inside, "::error file=" + here.filename().string() + "/a.toml::\n");
  EXPECT_EQ(outside, "::error file=/a.toml::\n");
  EXPECT_EQ(github::command({.file = "./sub/../a.toml"}), "::error file=a.toml::\n");
}

TEST(GitHub, NoLineOfALogIsACommand) {
  const std::string text = "::error::one\n  ::add-mask::x\n::0::\n";
  EXPECT_THAT(commands(text), testing::SizeIs(3)) << "or this test finds nothing";
  EXPECT_THAT(commands(github::verbatim(text)), testing::IsEmpty());
  EXPECT_NE(github::verbatim(text), github::verbatim(text)) << "a token that can be guessed";
}

TEST(GitHub, MarkdownIsText) {
  EXPECT_THAT(github::escaped("a|b<i>`*_[x](y)@z\n# &amp;"),
              Not(testing::ContainsRegex("[|<>`*_@\n]|\\]\\(")));
  EXPECT_EQ(github::escaped("velocity 1.5, 2"), "velocity 1.5, 2");
}

TEST_F(Formats, GoldenAnnotatesTheSceneAndWritesTheSummary) {
  const std::string summary = "GITHUB_STEP_SUMMARY=summary.md ";
  ASSERT_EQ(obscura("golden scene.toml --update").exit, 0);
  Outcome run = shell(summary + OBSCURA_BINARY " golden scene.toml --format github");
  EXPECT_EQ(run.exit, 0);
  EXPECT_THAT(run.out, HasSubstr("2 moments, 2 same"));
  EXPECT_THAT(commands(run.out), ElementsAre());
  EXPECT_EQ(contents(path("summary.md")), "### Golden images: 2 moments, all good\n\n");
  ball("purple");
  run = shell(summary + OBSCURA_BINARY " golden scene.toml --format github");
  EXPECT_EQ(run.exit, 1);
  const auto all = commands(run.out);
  ASSERT_EQ(all.size(), 2u) << run.out;
  EXPECT_THAT(all[1], StartsWith("::error file=scene.toml,line=10,title=scene%2C t = 0.5 s%3A differs::"));
  EXPECT_THAT(all[1], HasSubstr("ball.color is \"green\" and \"purple\""));
  EXPECT_THAT(all[1], HasSubstr("%0A"));
  const std::string text = contents(path("summary.md"));
  EXPECT_THAT(text, StartsWith("### Golden images: 2 moments, all good")) << "it is appended to";
  EXPECT_THAT(text, HasSubstr("### Golden images: 2 of 2 moments not good"));
  EXPECT_THAT(text, HasSubstr("| scene, t = 0.5 s | **differs** | "));
  // without a summary's file there is none, and that is no fault
  EXPECT_EQ(shell("unset GITHUB_STEP_SUMMARY; " OBSCURA_BINARY " golden scene.toml --format github").exit, 1);
  EXPECT_EQ(
      shell("GITHUB_STEP_SUMMARY=none/summary.md " OBSCURA_BINARY " golden scene.toml --format github").exit,
      4);
}

TEST_F(Formats, CheckVerifyAndCompareAnnotateToo) {
  scene("duration = -1\n", "broken.toml");
  EXPECT_THAT(commands(obscura("check scene.toml broken.toml --format github").out),
              ElementsAre(StartsWith("::error file=broken.toml,line=1,col=12,title=scene::")));
  ASSERT_EQ(obscura("render scene.toml --at 0 --size 160x90 -o a.png").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --at 0 --size 160x90 -o b.png --set ball.color=purple").exit, 0);
  EXPECT_THAT(commands(obscura("compare a.png b.png --format github").out),
              ElementsAre(StartsWith("::error title=compare::a.png and b.png differ")));
  EXPECT_THAT(commands(obscura("compare a.png a.png --format github").out), ElementsAre());
  ball("purple");
  EXPECT_THAT(commands(obscura("verify a.png --scene scene.toml --format github").out),
              ElementsAre(StartsWith("::error file=a.png,title=verify::a.png: no longer true")));
}

}  // namespace
}  // namespace obscura::app
