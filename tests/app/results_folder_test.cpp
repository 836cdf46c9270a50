#include "app/results_folder.hpp"

#include <set>

#include "../io/temporary_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

// Relative paths of all files in the folder.
std::set<std::string> files_of(const TemporaryFolder& folder) {
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
    if (!entry.is_directory()) files.insert(entry.path().lexically_relative(folder.path()));
  }
  return files;
}

TEST(EarlierResults, RemovesOnlyResults) {
  const TemporaryFolder folder;
  folder.write("comparison.json",
               R"({"estimators": [{"name": "flow", "frames": {}}, {"name": "mine", "frames": {}},
                   {"name": "../sibling", "frames": {}}, {"name": "trials"}, 7]})");
  for (const char* name : {"report.html", "summary.json.17.part", "notes.txt", "flow/estimates.csv",
                           "flow/commands.csv", "mine/trajectory.tum", "mine/notes.txt",
                           "mine/report.html", "trials/estimates.csv", "other/summary.json"}) {
    folder.write(name, "x");
  }
  remove_earlier_results(folder.path(), {folder.path() / "mine/trajectory.tum"});
  EXPECT_EQ(files_of(folder),
            (std::set<std::string>{"notes.txt", "mine/trajectory.tum", "mine/notes.txt",
                                   "trials/estimates.csv", "other/summary.json"}));
  EXPECT_FALSE(fs::exists(folder.path() / "flow"));
}

TEST(EarlierResults, RemovesOnlyTheFileOfAnInvalidComparison) {
  const TemporaryFolder folder;
  folder.write("comparison.json", "{");
  folder.write("flow/estimates.csv", "x");
  remove_earlier_results(folder.path(), {});
  EXPECT_EQ(files_of(folder), std::set<std::string>{"flow/estimates.csv"});
}

}  // namespace
}  // namespace stillkite
