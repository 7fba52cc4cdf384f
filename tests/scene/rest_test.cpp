// Heaps of scenes come to rest, and say so.

#include <gtest/gtest.h>

#include <string>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

// The overlap that is let be goes by the larger of two that touch, and so does that in which they rest: a
// heap of small boxes between walls eight times as long.
TEST(Rest, OfAHeapInABinOfLongWalls) {
  for (const bool space : {false, true}) {
    const auto at = [&](const std::string& x, const std::string& y) {
      return "[" + x + ", " + y + (space ? ", 0]" : "]");
    };
    const auto wall = [&](const char* x) {
      return "[[box]]\nfixed = true\nposition = " + at(x, "0.9") + "\nsize = [0.1, 1.8" +
             (space ? ", 0.3]\n" : "]\n");
    };
    const TextRun run("duration = 10\n[room]\nwalls = \"ground\"\n" +
                      std::string(space ? "size = [4, 4, 4]\n" : "size = [4, 4]\n") +
                      "[physics]\nsolver = \"iterative\"\nrate = 300\n" + wall("1.6") + wall("2.4") +
                      "[[box]]\nname = \"b\"\nelasticity = 0\nposition = " + at("1.8", "0.3") +
                      "\nsize = [0.2, 0.16" + (space ? ", 0.3]\n" : "]\nangle = { from = 0, to = 200 }\n") +
                      "copies = { count = [2, 7" + (space ? ", 1" : "") + "], offset = [" + at("0.3", "0") +
                      ", " + at("0", "0.3") + (space ? ", [0, 0, 1]" : "") + "] }\n");
    const sim::Snapshot now = run.at(8);
    for (std::size_t i = 2; i < now.bodies.size(); ++i) {
      EXPECT_TRUE(now.bodies[i].at_rest) << space << " " << i;
      EXPECT_EQ(now.bodies[i].velocity.norm(), 0) << space << " " << i;
    }
  }
}

}  // namespace
}  // namespace obscura::scene
