// What a message suggests, and that one mistake is told of once.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/error.h"
#include "scene/scene.h"

namespace obscura::scene {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

const std::string kHintedBall = "[[ball]]\nname = \"a\"\nradius = 0.3\nposition = [1, 1]\n";

std::vector<std::string> hints_of(const std::string& text) {
  try {
    parse(text, "a.toml");
  } catch (const Error& error) {
    std::vector<std::string> lines;
    for (const Complaint& complaint : error.complaints) lines.push_back(complaint.text());
    return lines;
  }
  return {};
}

TEST(Hints, AMarkOfABodyThatIsNotThereIsToldOnce) {
  EXPECT_THAT(hints_of(kHintedBall + "[[film.vector]]\nquantity = \"velocity\"\nof = \"b\""),
              ElementsAre("a.toml:7:6: no body is called 'b'; did you mean 'a'?"));
  EXPECT_THAT(hints_of(kHintedBall + "[[film.vector]]\nquantity = \"velocity\""),
              ElementsAre("a.toml:5:1: this vector needs 'of', the body that has it"));
}

TEST(Hints, PlotsOfNothingTakeNoRoom) {
  const std::string wrong = "[[film.plot]]\nof = \"a\"\nquantity = [\"speeed\"]\n";
  EXPECT_THAT(hints_of(kHintedBall + wrong + wrong + wrong),
              ElementsAre(HasSubstr("'speeed'"), HasSubstr("'speeed'"), HasSubstr("'speeed'")));
  // too many of them are told of once, with what all take
  const std::string plot = "[[film.plot]]\nof = \"a\"\nquantity = [\"speed\"]\n";
  EXPECT_THAT(hints_of(kHintedBall + plot + plot + plot + plot),
              ElementsAre("a.toml:11:1: the plots take 120 percent of the picture: 75 is the most"));
}

TEST(Hints, AListOfOneWordIsWrittenInBrackets) {
  EXPECT_THAT(hints_of(kHintedBall + "[[film.plot]]\nof = \"a\"\nquantity = \"height\""),
              ElementsAre("a.toml:7:12: 'quantity': expected a list, got the string \"height\"; write it in "
                          "brackets: [\"height\"]"));
  EXPECT_THAT(hints_of(kHintedBall + "[[film.plot]]\nof = \"a\"\nquantity = \"heigth\""),
              ElementsAre(EndsWith("got 'heigth'; did you mean 'height'?")));
}

TEST(Hints, OfAFilm) {
  const auto film = [](const std::string& key) { return hints_of(kHintedBall + "[film]\n" + key + "\n"); };
  for (const char* key : {"width = 640", "height = 360"})
    EXPECT_THAT(film(key), ElementsAre(EndsWith("it is size = [width, height] here, in pixels"))) << key;
  for (const char* key : {"framerate = 30", "frame_rate = 30"})
    EXPECT_THAT(film(key), ElementsAre(EndsWith("it is 'fps' here"))) << key;
  for (const char* key : {"start = 5", "end = 2"})
    EXPECT_THAT(film(key), ElementsAre(AllOf(HasSubstr("'duration'"), HasSubstr("--from 2 --to 5")))) << key;
  EXPECT_THAT(film("text = { text = \"hi\" }"), ElementsAre(EndsWith("did you mean [[film.label]]?")));
  EXPECT_THAT(film("[[film.arrow]]\nof = \"a\""), ElementsAre(EndsWith("did you mean [[film.vector]]?")));
  EXPECT_THAT(hints_of(kHintedBall + "[[figure.arrow]]\nof = \"a\""),
              ElementsAre(EndsWith("did you mean [[figure.vector]]?")));
}

TEST(Hints, OfTablesAtTheTop) {
  EXPECT_THAT(hints_of("[[circle]]"),
              ElementsAre("a.toml:1:3: unknown key 'circle'; did you mean [[ball]]?"));
  EXPECT_THAT(hints_of("[[rectangle]]"),
              ElementsAre("a.toml:1:3: unknown key 'rectangle'; did you mean [[box]]?"));
  EXPECT_THAT(hints_of("[simulation]"),
              ElementsAre("a.toml:1:2: unknown key 'simulation'; did you mean [physics]?"));
  // a table belongs where it is one
  EXPECT_THAT(hints_of("[[label]]"), ElementsAre("a.toml:1:3: unknown key 'label'; it belongs in [film]"));
  EXPECT_THAT(hints_of("[[plot]]"), ElementsAre("a.toml:1:3: unknown key 'plot'; it belongs in [film]"));
  EXPECT_THAT(hints_of(kHintedBall + "[[spring]]\nbetween = [\"a\", [2, 3]]\nto = [2, 3]"),
              ElementsAre(EndsWith("unknown key 'to' in [[spring]]; it is 'between' here, its two ends")));
}

TEST(Hints, SignsOfSlidesAreNamed) {
  const auto sign = [](const std::string& line) { return hints_of("[[ball]]\n" + line + "\n"); };
  for (const char* line :
       {"radius = \u22120.3", "velocity = [1, \u22122]", "mass = 1e\u22123", "mass = \u20131"})
    EXPECT_THAT(sign(line), ElementsAre(HasSubstr("not TOML: a minus is the - of the keyboard"))) << line;
  EXPECT_THAT(sign("name = \u201Ca\u201D"),
              ElementsAre("a.toml:2:8: not TOML: quotes are straight: \"a\", not \u201C"));
  EXPECT_THAT(sign("name = \u2018a\u2019"), ElementsAre(HasSubstr("quotes are straight")));
  // in a string they are words
  EXPECT_THAT(hints_of("title = \"\u22121 \u201Ca\u201D\"\n[[ball]]"), ElementsAre());
  EXPECT_THAT(sign("position = (1, 1)"),
              ElementsAre("a.toml:2:12: not TOML: a list is in square brackets: [1, 2]"));
}

TEST(Hints, CommandsOfMathematicsAreWrittenWithTwoBackslashes) {
  for (const char* word : {"alpha", "lambda", "Delta", "omega", "uparrow", "xi", "Uparrow"}) {
    const std::string wrong = std::string("[[ball]]\nlabel = \"a \\") + word + " b\"\n";
    EXPECT_THAT(hints_of(wrong), ElementsAre(EndsWith(std::string("write '\\\\") + word + "' for '\\" + word +
                                                      "', or put the text in single quotes")))
        << word;
  }
}

TEST(Hints, TrueAndFalseAreSmallAndWithoutQuotes) {
  EXPECT_THAT(hints_of("[[ball]]\nfixed = True\n"), ElementsAre(EndsWith("it is written true, not True")));
  EXPECT_THAT(hints_of("[[ball]]\nfixed = FALSE\n"), ElementsAre(EndsWith("it is written false, not FALSE")));
  EXPECT_THAT(hints_of("[[ball]]\nfixed = \"True\"\n"), ElementsAre(HasSubstr("without quotes")));
}

TEST(Hints, NumbersAreWithoutUnits) {
  const auto number = [](const std::string& line) { return hints_of("[[ball]]\n" + line + "\n"); };
  for (const char* line : {"mass = 2kg", "mass = 2 kg", "radius = 20 cm", "velocity = [1 m/s, 2]",
                           "mass = 2.5kg", "radius = 1e-2m"})
    EXPECT_THAT(number(line), ElementsAre(HasSubstr("a number has no unit, all are in m, kg, s and degrees")))
        << line;
  EXPECT_THAT(number("radius = 20 cm"), ElementsAre(EndsWith("; got 20 cm")));
}

// What only stands behind a number is no unit, and a backslash that is written twice is right.
TEST(Hints, OfUnitsAndEscapesAreForTheseAlone) {
  for (const char* line :
       {"ball2 kg = 3", "mass = 10 radius = 2", "mass = 2 // heavy", "mass = 10 true", "mass = 0x1g"})
    EXPECT_THAT(hints_of("[[ball]]\n" + std::string(line) + "\n"),
                Not(testing::Contains(HasSubstr("has no unit"))))
        << line;
  for (const char* line : {"label = \"a \\\\alpha", "label = \"a \\u12\""})
    EXPECT_THAT(hints_of("[[ball]]\n" + std::string(line) + "\n"),
                Not(testing::Contains(HasSubstr("is written twice"))))
        << line;
}

TEST(Hints, AnAngleHasAVertex) {
  EXPECT_THAT(hints_of(kHintedBall + "[[figure.angle]]\nbetween = [\"a\", [2, 3]]\n"),
              testing::Contains(EndsWith("an angle is 'at' its vertex, from 'from' to 'to'")));
}

TEST(Hints, NumbersAreNoCalculations) {
  const auto number = [](const std::string& line) { return hints_of("[[ball]]\n" + line + "\n"); };
  for (const char* line : {"mass = 1/3", "position = [1, 2*3]", "mass = 2+1"})
    EXPECT_THAT(number(line),
                ElementsAre(EndsWith("not TOML: a value is a number, not a calculation: 0.5, not 1/2")))
        << line;
  for (const char* line : {"mass = 3.", "position = [1., 2]", "mass = 3. # kg"})
    EXPECT_THAT(number(line), ElementsAre(EndsWith("not TOML: a number has a digit after its point: 3.0")))
        << line;
  for (const char* line : {"position = [1 1]", "position = [1.5 -1]"})
    EXPECT_THAT(number(line),
                ElementsAre(EndsWith("not TOML: the values of a list have commas between them: [1, 2]")))
        << line;
  EXPECT_THAT(number("position = [1, 2"), ElementsAre(Not(HasSubstr("commas"))));
}

}  // namespace
}  // namespace obscura::scene
