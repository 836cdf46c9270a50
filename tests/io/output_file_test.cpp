#include "io/output_file.hpp"

#include "io/text_file.hpp"
#include "temporary_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

TEST(OutputFile, AppearsWholeOrNotAtAll) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "a.txt";
  {
    OutputFile out(file);
    out.write("half");
    EXPECT_FALSE(fs::exists(file));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
  write_file(file, "old");
  {
    OutputFile out(file);
    out.write("new");
  }
  EXPECT_EQ(read_text_file(file), "old");
  {
    OutputFile out(file);
    out.write("new");
    out.commit();
  }
  EXPECT_EQ(read_text_file(file), "new");
}

TEST(OutputFile, AFullDiskIsSaid) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TemporaryFolder folder;
  fs::create_symlink("/dev/full", folder.path() / "a.txt.part");
  OutputFile out(folder.path() / "a.txt");
  try {
    out.write("x");
    out.commit();
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("a.txt: cannot be written: No space left"),
              std::string::npos)
        << error.what();
  }
}

TEST(OutputFile, FoldersThatCannotBeUsedAreRejectedFirst) {
  const TemporaryFolder folder;
  prepare_output_folder(folder.path() / "a/b", 1);
  EXPECT_TRUE(fs::is_empty(folder.path() / "a/b"));
  folder.write("taken", "x");
  EXPECT_THROW(prepare_output_folder(folder.path() / "taken", 1), InputError);
  EXPECT_THROW(prepare_output_folder(folder.path() / "a", std::uintmax_t{1} << 60), InputError);
  EXPECT_THROW(prepare_output_folder("/proc/stillkite", 1), InputError);
}

TEST(OutputFile, NoResultTakesThePlaceOfWhatIsRead) {
  const TemporaryFolder folder;
  const std::filesystem::path truth = folder.file("out/trajectory.tum", "1 0 0 1 0 0 0 1\n");
  const auto error = [&](const std::filesystem::path& out) {
    return input_error_of(folder, [&] { protect_inputs(out, {"trajectory.tum"}, {truth}); });
  };
  EXPECT_EQ(error(folder.path() / "out" / ".." / "out"),
            "out/trajectory.tum: is read, and would be overwritten by the results; choose another "
            "folder with --out");
  EXPECT_EQ(error(folder.path() / "elsewhere"), "accepted");
}

}  // namespace
}  // namespace stillkite
