#include "io/results/output_folder.hpp"

#include <gtest/gtest.h>

#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

TEST(OutputFolder, AppearsOnCommit) {
  const TemporaryFolder folder;
  for (const char* name : {"made", "slash/"}) {
    OutputFolder out(folder.path() / name, 0);
    std::ofstream(out.part() / "file") << "x";
    EXPECT_FALSE(fs::exists(folder.path() / name));
    out.commit();
    EXPECT_TRUE(fs::exists(folder.path() / name / "file"));
    EXPECT_FALSE(fs::exists(out.part()));
  }
}

TEST(OutputFolder, IsRemovedWithoutCommit) {
  const TemporaryFolder folder;
  {
    const OutputFolder out(folder.path() / "made", 0);
    std::ofstream(out.part() / "file") << "x";
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(OutputFolder, FollowsASymbolicLink) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "disk/flight");
  fs::create_symlink("disk/flight", folder.path() / "link");
  OutputFolder out(folder.path() / "link", 0);
  std::ofstream(out.part() / "file") << "x";
  out.commit();
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
  EXPECT_TRUE(fs::exists(folder.path() / "disk/flight/file"));
}

TEST(OutputFolder, KeepsAnExistingPartFolder) {
  const TemporaryFolder folder;
  const fs::path file = folder.file("flight.part/precious", "x");
  EXPECT_EQ(input_error_of(folder, [&] { OutputFolder(folder.path() / "flight", 0); }),
            "flight.part: already exists, possibly left by a killed run; remove it");
  EXPECT_TRUE(fs::exists(file));
}

TEST(OutputFolder, AcceptsOnlyEmptyExistingFolders) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "empty");
  OutputFolder(folder.path() / "empty", 0).commit();
  EXPECT_TRUE(fs::is_directory(folder.path() / "empty"));

  const fs::path file = folder.file("full/precious", "x");
  EXPECT_EQ(input_error_of(folder, [&] { OutputFolder(folder.path() / "full", 0); }),
            "full: already exists; remove it or choose another folder with --out");
  EXPECT_EQ(input_error_of(folder, [&] { OutputFolder(file, 0); }),
            "full/precious: already exists; remove it or choose another folder with --out");
  EXPECT_TRUE(fs::exists(file));
}

}  // namespace
}  // namespace stillkite
