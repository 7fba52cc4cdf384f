// Manual pages, and what completes lines in shells: both say what --help says, and are tried by those that
// read them.

#include <gmock/gmock.h>

#include <regex>
#include <set>
#include <sstream>

#include "app/program.h"
#include "needs.h"

namespace obscura::app {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

class Manual : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    std::istringstream lines(obscura("--help").out);
    bool inside = false;
    for (std::string line; std::getline(lines, line);) {
      if (line.empty()) inside = false;
      if (inside) commands_.push_back(line.substr(2, line.find(' ', 2) - 2));
      if (line == "Subcommands:") inside = true;
    }
    ASSERT_THAT(commands_, AllOf(Contains("render"), Contains("docs")));
  }

  /// The options of a command as its --help lists them.
  std::set<std::string> options(const std::string& command) const {
    const std::string help = obscura(command + " --help").out;
    const std::regex option("\n  ((-[a-z],)?--[a-z-]+)");
    std::set<std::string> found;
    for (std::sregex_iterator it(help.begin(), help.end(), option), end; it != end; ++it) {
      std::istringstream names((*it)[1].str());
      for (std::string name; std::getline(names, name, ',');) found.insert(name);
    }
    return found;
  }

  std::vector<std::string> commands_;
};

TEST_F(Manual, HasAPageForEveryCommandWithEveryOption) {
  commands_.push_back("");
  for (const std::string& command : commands_) {
    const Outcome page = obscura("docs man " + command);
    ASSERT_EQ(page.exit, 0) << page.err;
    const std::string bare = std::regex_replace(page.out, std::regex(R"(\\f[BIR]|\\(?=-))"), "");
    for (const std::string& option : options(command)) {
      EXPECT_TRUE(std::regex_search(bare, std::regex("(^|\n|, )" + option + "[, \n]")))
          << command << " " << option;
    }
    EXPECT_THAT(bare, AllOf(HasSubstr("\n.SH NAME\nobscura" + (command.empty() ? "" : "-" + command) + " - "),
                            HasSubstr(".SH EXIT STATUS\n.TP\n0\n")));
  }
}

TEST_F(Manual, IsReadWithoutAWarning) {
  OBSCURA_NEEDS(installed("groff") && installed("mandoc"), "groff-base, mandoc");
  commands_.push_back("");
  for (const std::string& command : commands_) {
    const Outcome lint = shell("SOURCE_DATE_EPOCH=1700000000 " OBSCURA_BINARY " docs man " + command +
                               " > page.1 && mandoc -T lint page.1");
    EXPECT_EQ(lint.exit, 0) << command << lint.out;
    EXPECT_THAT(lint.out, IsEmpty());
    const Outcome set = shell("groff -ww -b -man -T utf8 page.1 2>&1 >page.txt");
    EXPECT_EQ(set.exit, 0) << command;
    EXPECT_THAT(set.out, IsEmpty()) << command;
  }
}

TEST_F(Manual, ShowsWhatOneTypesAsItIsTyped) {
  OBSCURA_NEEDS(installed("mandoc"), "mandoc");
  const std::string page = shell("SOURCE_DATE_EPOCH=1700000000 " OBSCURA_BINARY
                                 " docs man render | mandoc -T ascii -O width=200 | col -b")
                               .out;
  EXPECT_THAT(
      page, AllOf(HasSubstr("obscura render scenes/room.toml -o 'frames/{frame:04}.png' --from 2 --to 3"),
                  HasSubstr("2023-11-14"), HasSubstr("--crf FLOAT"),
                  HasSubstr("lower is better [18] (1 to 63)"), HasSubstr("obscura render [OPTIONS] SCENE")));
}

TEST_F(Manual, KnowsItsCommands) {
  const Outcome wrong = obscura("docs man rendre");
  EXPECT_EQ(wrong.exit, 2);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("there is no such command"), HasSubstr("render")));
  EXPECT_EQ(obscura("docs keys render").exit, 2);
}

class Completion : public Manual {
 protected:
  void SetUp() override {
    Manual::SetUp();
    for (const char* shell_name : {"bash", "zsh", "fish"}) {
      const std::string name = shell_name;
      ASSERT_EQ(shell(OBSCURA_BINARY " docs " + name + " > obscura." + name).exit, 0);
    }
    shell("mkdir scenes && touch ball.toml 'two balls.toml' run.csv notes.txt");
  }

  using Words = std::vector<std::string>;
  Words lines(const Outcome& outcome) const {
    EXPECT_EQ(outcome.exit, 0) << outcome.err;
    EXPECT_THAT(outcome.err, IsEmpty());
    Words words;
    std::istringstream all(outcome.out);
    for (std::string line; std::getline(all, line);) words.push_back(line);
    return words;
  }

  /// What is offered behind the words of a line; the last one is begun.
  Words bash(const std::string& words) const {
    return lines(
        shell("bash -uc 'source obscura.bash; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _obscura; "
              "[ ${#COMPREPLY[@]} = 0 ] || printf \"%s\\n\" \"${COMPREPLY[@]}\"' - obscura " +
              words));
  }
  Words fish(const std::string& line) const {
    Words words = lines(
        shell("HOME=$PWD fish --no-config -c 'source obscura.fish; complete -C \"obscura " + line + "\"'"));
    for (std::string& word : words) word.resize(std::min(word.find('\t'), word.size()));
    return words;
  }
  /// In a terminal of its own, which lists at ^D; it ends when the line behind has been read.
  std::string zsh(const std::string& line) const {
    std::ofstream(path("ask.zsh")) << R"(zmodload zsh/zpty
TERM=dumb zpty z zsh -f -i
zpty -w z 'stty -echo rows 500 cols 200; unset zle_bracketed_paste; unsetopt prompt_cr prompt_sp; LISTMAX=10000 RPS1='
zpty -w z 'autoload -Uz compinit; compinit -D -u; source ./obscura.zsh; PS1=$'\''AW\x41IT '\'
zpty -r z said '*AWAIT*'
zpty -w -n z "$1"$'\C-d\C-u'
zpty -w z 'print DONE-$((1 + 1))'
zpty -r z said '*DONE-2*'
print -rn -- $said
zpty -d z
)";
    const Outcome asked = shell("HOME=$PWD " OBSCURA_NOT_FOR_EVER "zsh -f ask.zsh '" + line + "'");
    EXPECT_EQ(asked.exit, 0) << asked.err;
    return asked.out;
  }
};

TEST_F(Completion, OfBash) {
  EXPECT_THAT(bash("''"), AllOf(Contains("render"), Contains("docs"), Contains("--version")));
  EXPECT_THAT(bash("rend"), UnorderedElementsAre("render"));
  EXPECT_THAT(bash("render --the"), UnorderedElementsAre("--theme"));
  EXPECT_THAT(bash("render --theme ''"), UnorderedElementsAre("paper", "screen"));
  EXPECT_THAT(bash("render --theme = p"), UnorderedElementsAre("paper"));
  EXPECT_THAT(bash("render --backend e"), UnorderedElementsAre("egl"));
  EXPECT_THAT(bash("render ''"), UnorderedElementsAre("ball.toml", "two balls.toml", "scenes"));
  EXPECT_THAT(bash("render --at 1 b"), UnorderedElementsAre("ball.toml"));
  EXPECT_THAT(bash("render --at ''"), IsEmpty());
  EXPECT_THAT(bash("check ball.toml t"), UnorderedElementsAre("two balls.toml"));
  EXPECT_THAT(bash("golden --states ''"), UnorderedElementsAre("run.csv", "scenes"));
  EXPECT_THAT(bash("golden --references ''"), UnorderedElementsAre("scenes"));
  EXPECT_THAT(bash("render ball.toml -o n"), UnorderedElementsAre("notes.txt"));
  EXPECT_THAT(bash("docs man sw"), UnorderedElementsAre("sweep"));
  for (const std::string& command : commands_) {
    const Words offered = bash(command + " -");
    EXPECT_EQ(std::set<std::string>(offered.begin(), offered.end()), options(command)) << command;
  }
}

TEST_F(Completion, OfFish) {
  OBSCURA_NEEDS(installed("fish"), "fish");
  EXPECT_THAT(fish("rend"), UnorderedElementsAre("render"));
  EXPECT_THAT(fish("render --theme "), UnorderedElementsAre("paper", "screen"));
  EXPECT_THAT(fish("render --backend=e"), UnorderedElementsAre("--backend=egl"));
  EXPECT_THAT(fish("render "), UnorderedElementsAre("ball.toml", "two balls.toml", "scenes/"));
  EXPECT_THAT(fish("render --at "), IsEmpty());
  EXPECT_THAT(fish("golden --states "), UnorderedElementsAre("run.csv", "scenes/"));
  EXPECT_THAT(fish("render -o n"), UnorderedElementsAre("notes.txt"));
  EXPECT_THAT(fish("docs man sw"), UnorderedElementsAre("sweep"));
  EXPECT_THAT(fish(""), IsSupersetOf(commands_));
  for (const std::string& command : commands_) {
    const Words offered = fish(command + " --");
    for (const std::string& option : options(command)) {
      // behind a short one fish offers its values
      if (option.starts_with("--")) {
        EXPECT_THAT(offered, Contains(option)) << command;
      }
    }
  }
}

TEST_F(Completion, OfZsh) {
  OBSCURA_NEEDS(installed("zsh"), "zsh");
  const std::string commands = zsh("obscura ");
  for (const std::string& command : commands_) EXPECT_THAT(commands, HasSubstr("\n" + command + " "));
  EXPECT_THAT(zsh("obscura render --theme "), HasSubstr("paper   screen"));
  const std::string scenes = zsh("obscura render ");
  EXPECT_THAT(scenes,
              AllOf(HasSubstr("ball.toml"), HasSubstr("two\\ balls.toml"), Not(HasSubstr("notes.txt"))));
  EXPECT_THAT(zsh("obscura golden --states "), AllOf(HasSubstr("run.csv"), Not(HasSubstr("ball.toml"))));
  EXPECT_THAT(zsh("obscura docs man s"), AllOf(HasSubstr("states"), HasSubstr("submit"), HasSubstr("sweep")));
  for (const std::string& command : commands_) {
    const std::string offered = zsh("obscura " + command + " -");
    for (const std::string& option : options(command)) EXPECT_THAT(offered, HasSubstr(option)) << command;
  }
}

}  // namespace
}  // namespace obscura::app
