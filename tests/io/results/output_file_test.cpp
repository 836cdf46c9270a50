#include "io/results/output_file.hpp"

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <set>

#include "io/text_file.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

TEST(OutputFile, AppearsCompleteOrNotAtAll) {
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

// RLIMIT_FSIZE simulates a full disk.
TEST(OutputFile, ReportsAFullDiskAndKeepsCompleteLines) {
  const TemporaryFolder folder;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{.rlim_cur = 10, .rlim_max = before.rlim_max};
  std::signal(SIGXFSZ, SIG_IGN);
  OutputFile out(folder.path() / "a.txt");
  std::string message;
  setrlimit(RLIMIT_FSIZE, &small);
  try {
    out.write("a line\nanother line\n");
    out.commit();
  } catch (const std::runtime_error& error) {
    message = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_NE(message.find("a.txt: cannot be written: File too large"), std::string::npos) << message;
  out.commit();
  EXPECT_EQ(read_text_file(folder.path() / "a.txt"), "a line\n");
}

// The second file of the first call cannot be created.
TEST(OutputFile, WritesSeveralFilesTogetherOrNone) {
  const TemporaryFolder folder;
  folder.write("a.txt", "old");
  EXPECT_THROW(write_files(folder.path(), {{"a.txt", "new"}, {"none/b.txt", "new"}}), InputError);
  EXPECT_EQ(read_text_file(folder.path() / "a.txt"), "old");
  write_files(folder.path(), {{"a.txt", "new"}, {"b.txt", "new"}});
  EXPECT_EQ(read_text_file(folder.path() / "a.txt"), "new");
  EXPECT_EQ(read_text_file(folder.path() / "b.txt"), "new");
}

TEST(OutputFile, SimultaneousWritersDoNotMix) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "a.txt";
  OutputFile first(file);
  first.write("first");
  OutputFile second(file);
  second.write("2nd");
  first.commit();
  EXPECT_EQ(read_text_file(file), "first");
  second.commit();
  EXPECT_EQ(read_text_file(file), "2nd");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(OutputFile, RemovesPartFilesOfKilledProcesses) {
  const TemporaryFolder folder;
  const OutputFile alive(folder.path() / "a.txt");
  for (const char* name : {"a.txt.part", "a.txt.17.part", "a.txt.old.part", "b.txt.17.part"}) {
    folder.write(name, "half");
  }
  write_file(folder.path() / "a.txt", "whole");
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    names.insert(entry.path().filename().string());
  }
  EXPECT_EQ(names, (std::set<std::string>{"a.txt", fmt::format("a.txt.{}.part", getpid()),
                                          "a.txt.old.part", "b.txt.17.part"}));
}

TEST(OutputFile, RejectsUnusableOutputFolders) {
  const TemporaryFolder folder;
  prepare_output_folder(folder.path() / "a/b", 1);
  EXPECT_TRUE(fs::is_empty(folder.path() / "a/b"));
  folder.write("taken", "x");
  EXPECT_THROW(prepare_output_folder(folder.path() / "taken", 1), InputError);
  EXPECT_THROW(prepare_output_folder(folder.path() / "a", std::uintmax_t{1} << 60), InputError);
  EXPECT_THROW(prepare_output_folder("/proc/stillkite", 1), InputError);
}

TEST(OutputFile, ProtectsInputFilesFromResults) {
  const TemporaryFolder folder;
  const std::filesystem::path truth = folder.file("out/trajectory.tum", "1 0 0 1 0 0 0 1\n");
  const auto error = [&](const std::filesystem::path& out) {
    return input_error_of(folder, [&] { protect_inputs(out, {"trajectory.tum"}, {truth}); });
  };
  EXPECT_EQ(error(folder.path() / "out" / ".." / "out"),
            "out/trajectory.tum: is an input file that the results would overwrite; choose another "
            "folder with --out");
  EXPECT_EQ(error(folder.path() / "elsewhere"), "accepted");
}

}  // namespace
}  // namespace stillkite
