// The front door: what lies at the top level of the tree.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "where.h"

namespace {

using Names = std::set<std::string>;

// The first part of every tracked path; without git, or outside a checkout, what lies there and is not built
// or hidden.
Names top_level(const std::filesystem::path& top) {
  Names names;
  const std::string command = "git -C '" + top.string() + "' ls-files 2>/dev/null";
  if (const std::unique_ptr<FILE, int (*)(FILE*)> listing(popen(command.c_str(), "r"), pclose); listing) {
    std::array<char, 4096> line;
    while (std::fgets(line.data(), line.size(), listing.get())) {
      const std::string path = line.data();
      names.insert(path.substr(0, path.find_first_of("/\n")));
    }
  }
  if (!names.empty()) return names;
  for (const auto& entry : std::filesystem::directory_iterator(top))
    if (const std::string name = entry.path().filename(); name.rfind("build", 0) != 0 && name[0] != '.')
      names.insert(name);
  return names;
}

TEST(Layout, TheTopLevelHoldsOnlyTheAgreedNames) {
  const Names agreed = {"CMakeLists.txt",
                        "CMakePresets.json",
                        "README.md",
                        "LICENSE",
                        "CHANGELOG.md",
                        "CONTRIBUTING.md",
                        "src",
                        "shaders",
                        "scenes",
                        "tests",
                        "render_out",
                        "script",
                        "docs",
                        ".ci",
                        ".clang-format",
                        ".clang-tidy",
                        ".gitignore",
                        ".gitattributes"};
  const Names there = top_level(OBSCURA_SOURCE_DIR);
  ASSERT_THAT(there,
              testing::IsSupersetOf({std::string("src"), std::string("tests"), std::string("LICENSE")}));
  for (const std::string& name : there) EXPECT_TRUE(agreed.contains(name)) << name << " is not agreed";
}

}  // namespace
