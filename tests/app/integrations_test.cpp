// Golden images where others run them: pytest by script/pytest, GitHub's workflows by script/action.

#include <optional>
#include <sstream>

#include <gmock/gmock.h>

#include "needs.h"
#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;
using testing::Not;

class Integrations : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    std::filesystem::create_directories(path("scenes"));
    ball("green");
    scene("duration = 1\n", "scenes/plain.toml");
  }
  void ball(const std::string& color) const {
    scene(
        "duration = 2\n[room]\nsize = [4, 2.25]\n[[ball]]\nname = \"ball\"\nradius = 0.2\nposition = [1, 1]\n"
        "velocity = [1, 1]\ncolor = \"" +
            color + "\"\n[golden]\nat = [0, 0.5]\nsize = [160, 90]\n",
        "scenes/ball.toml");
  }
};

/// Debian's interpreter knows Debian's modules, whichever comes first in PATH.
std::optional<std::string> python_with(const std::string& module) {
  for (const std::string program : {"python3", "/usr/bin/python3"})
    if (std::system((program + " -c 'import " + module + "' >/dev/null 2>&1").c_str()) == 0) return program;
  return {};
}

class Pytest : public Integrations {
 protected:
  Outcome pytest(const std::string& arguments = "") const {
    return shell("PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=" OBSCURA_SOURCE_DIR "/script/pytest " +
                 python_.value_or("python3") +
                 " -m pytest -p obscura_pytest -p no:cacheprovider --rootdir . "
                 "--obscura=" OBSCURA_BINARY " " +
                 arguments);
  }
  const std::optional<std::string> python_ = python_with("pytest");
};

TEST_F(Pytest, ShowsTheCauseAndThePicture) {
  OBSCURA_NEEDS(python_, "python3-pytest");
  Outcome run = pytest("scenes");
  EXPECT_EQ(run.exit, 1) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("1 failed")) << "a scene without a [golden] is no test";
  EXPECT_THAT(run.out, HasSubstr("there is no such reference"));
  run = pytest("scenes --obscura-update");
  EXPECT_EQ(run.exit, 0) << run.out << run.err;
  EXPECT_TRUE(std::filesystem::exists(path("scenes/golden/ball-0.5.png")));
  ball("purple");
  run = pytest("scenes --junit-xml out.xml");
  EXPECT_EQ(run.exit, 1) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("scenes/ball, t = 0.5 s: differs"));
  EXPECT_THAT(run.out, HasSubstr("ball.color is \"green\" and \"purple\""));
  EXPECT_THAT(run.out, HasSubstr("states are the same: only the drawing differs"));
  EXPECT_THAT(run.out, HasSubstr("expected    " + path("scenes/golden/ball-0.5.png")));
  const std::string actual = path("render_out/golden/scenes/ball-0.5.png"),
                    difference = path("render_out/golden/scenes/ball-0.5.difference.png");
  EXPECT_THAT(run.out, HasSubstr("actual      " + actual));
  EXPECT_THAT(run.out, HasSubstr("difference  " + difference));
  EXPECT_TRUE(std::filesystem::exists(actual));
  EXPECT_THAT(contents(path("out.xml")), HasSubstr(difference));
  EXPECT_THAT(run.out, Not(HasSubstr("Traceback")));
}

TEST_F(Pytest, TakesItsSettingsFromTheProject) {
  OBSCURA_NEEDS(python_, "python3-pytest");
  scene("[pytest]\nobscura_references = references\nobscura_arguments = --actual 'what fails'\n",
        "pytest.ini");
  EXPECT_EQ(pytest("--obscura-update").exit, 0);
  EXPECT_TRUE(std::filesystem::exists(path("references/scenes/ball-0.5.png")));
  EXPECT_EQ(pytest().exit, 0);
  ball("purple");
  const Outcome run = pytest();
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("expected    " + path("references/scenes/ball-0.5.png")));
  EXPECT_TRUE(std::filesystem::exists(path("what fails/scenes/ball-0.5.png")));
}

TEST_F(Pytest, SaysWhatIsWrongWithASceneAndWithTheProgram) {
  OBSCURA_NEEDS(python_, "python3-pytest");
  scene("duration = -1\n[golden]\n", "scenes/broken.toml");
  Outcome run = pytest("scenes/broken.toml");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("scenes/broken.toml:1:12: "));
  run = pytest("scenes/ball.toml --obscura=./none");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("./none: No such file or directory; --obscura names another program"));
  scene("[pytest]\nobscura_arguments = --nonsense\n", "pytest.ini");
  run = pytest("scenes/ball.toml");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("exit code 2"));
  EXPECT_THAT(run.out, HasSubstr("--nonsense"));
  EXPECT_THAT(run.out, Not(HasSubstr("Traceback")));
}

class Action : public Integrations {
 protected:
  Outcome action(const std::string& environment = "") const {
    return shell("OBSCURA_PROGRAM=" OBSCURA_BINARY
                 " OBSCURA_SCENES=scenes GITHUB_OUTPUT=output.txt "
                 "GITHUB_STEP_SUMMARY=summary.md RUNNER_TEMP=\"$PWD/tmp\" GITHUB_WORKSPACE=\"$PWD\" " +
                 environment + " " OBSCURA_SOURCE_DIR "/script/action/golden");
  }
};

TEST_F(Action, AnnotatesSumsUpAndKeepsThePage) {
  ASSERT_EQ(obscura("golden scenes --update").exit, 0);
  Outcome run = action();
  EXPECT_EQ(run.exit, 0) << run.out << run.err;
  ball("purple");
  run = action();
  EXPECT_EQ(run.exit, 1) << run.out << run.err;
  EXPECT_THAT(
      run.out,
      HasSubstr("\n::error file=scenes/ball.toml,line=10,title=scenes/ball%2C t = 0.5 s%3A differs::"));
  EXPECT_THAT(contents(path("summary.md")), HasSubstr("### Golden images: 2 of 2 moments not good"));
  EXPECT_THAT(contents(path("output.txt")), HasSubstr("report=" + path("tmp/obscura-golden/report.html")));
  EXPECT_TRUE(std::filesystem::exists(path("tmp/obscura-golden/report.html")));
  EXPECT_TRUE(std::filesystem::exists(path("tmp/obscura-golden/junit.xml")));
  EXPECT_TRUE(std::filesystem::exists(path("tmp/obscura-golden/pictures/scenes/ball-0.5.difference.png")));
}

TEST_F(Action, InputsAreWordsAndNotCommands) {
  std::filesystem::rename(path("scenes"), path("my $(touch hacked) scenes"));
  const std::string environment =
      "OBSCURA_SCENES='  my $(touch hacked) scenes  \n\n' OBSCURA_REFERENCES='r $(touch hacked)' "
      "OBSCURA_ARGUMENTS='--update\n --jobs 1'";
  Outcome run = action(environment);
  EXPECT_EQ(run.exit, 0) << run.out << run.err;
  EXPECT_FALSE(std::filesystem::exists(path("hacked")));
  EXPECT_TRUE(std::filesystem::exists(path("r $(touch hacked)/my $(touch hacked) scenes/ball-0.5.png")))
      << run.out;
}

TEST_F(Action, RunsWhatIsThereAndPutsNoInputIntoAShell) {
  const auto python = python_with("yaml");
  OBSCURA_NEEDS(python, "python3-yaml");
  scene(R"(import yaml
with open(")" OBSCURA_SOURCE_DIR R"(/script/action/action.yml") as file:
    action = yaml.safe_load(file)
assert action["runs"]["using"] == "composite"
for step in action["runs"]["steps"]:
    assert "${{" not in step.get("run", ""), step
    assert ("run" in step) == ("shell" in step), step
golden = action["runs"]["steps"][0]
named = {value.split("inputs.")[1].split(" ")[0] for value in golden["env"].values() if "inputs." in value}
assert named == set(action["inputs"]) - {"artifact"}, named
print(" ".join(golden["env"]))
)",
        "look.py");
  const Outcome run = shell(*python + " look.py");
  ASSERT_EQ(run.exit, 0) << run.err;
  // what it hands over is what the script reads
  std::istringstream names(run.out);
  const std::string script = contents(OBSCURA_SOURCE_DIR "/script/action/golden");
  for (std::string name; names >> name;)
    if (name != "OBSCURA_ACTION") {
      EXPECT_THAT(script, HasSubstr("${" + name + ":-}"));
    }
}

}  // namespace
}  // namespace obscura::app
