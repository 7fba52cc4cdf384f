#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace obscura::architecture {

/// A tree of sources of the test's own.
class Planted : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(src_); }
  void TearDown() override { std::filesystem::remove_all(src_); }

  void plant(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((src_ / name).parent_path());
    std::ofstream(src_ / name) << text;
  }

  const std::filesystem::path src_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("obscura_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

}  // namespace obscura::architecture
