#include "io/dataset/table_reader.hpp"

#include <sys/stat.h>

#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

std::vector<std::pair<std::int64_t, double>> read(const std::filesystem::path& file) {
  TableReader table(file, Separator::comma, 2);
  std::vector<std::pair<std::int64_t, double>> rows;
  while (table.next()) {
    const Timestamp stamp = table.stamp();
    rows.emplace_back(stamp.ns, table.number(1));
  }
  return rows;
}

TEST(Stamps, AreExactBeyondDoublePrecision) {
  EXPECT_EQ(parse_stamp("1403715273262142976", 0)->ns, 1403715273262142976);
  EXPECT_EQ(parse_stamp("1403715273.262142976", 9)->ns, 1403715273262142976);
  EXPECT_EQ(parse_stamp("1.403715273262142976e+09", 9)->ns, 1403715273262142976);
  EXPECT_EQ(parse_stamp("-0.5", 9)->ns, -500000000);
  EXPECT_EQ(parse_stamp("2.5", 6)->ns, 2500000);
  EXPECT_EQ(parse_stamp("1e-10", 9)->ns, 0);
  EXPECT_EQ(parse_stamp("0.0000000005", 9)->ns, 1);
  for (const char* bad : {"", "nan", "1x", "1.2.3", "--1", "e5", "1e", "9e99", "."}) {
    EXPECT_FALSE(parse_stamp(bad, 9).has_value()) << bad;
  }
  for (const std::int64_t ns : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{-1500000000},
                                std::int64_t{1403715273262142976}}) {
    EXPECT_EQ(parse_stamp(print_seconds({ns}), 9)->ns, ns);
  }
}

TEST(TableReader, ReadsWithAndWithoutHeader) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::int64_t, double>> expected{{10, 1.5}, {20, -2}};
  for (const char* names : {"", "#timestamp [ns],v\n", "t,v\n", "\xef\xbb\xbft,v\r\n",
                            "# a comment\n\n# t [ns], v\n"}) {
    EXPECT_EQ(read(folder.file("a.csv", std::string(names) + "10,1.5\r\n# between\n20, -2\n")),
              expected)
        << names;
  }
}

TEST(TableReader, FirstColumnNameGivesTimeUnit) {
  const TemporaryFolder folder;
  EXPECT_EQ(read(folder.file("a.csv", "t [s],v\n0.25,1\n"))[0].first, 250000000);
  EXPECT_EQ(read(folder.file("a.csv", "t [ms],v\n0.25,1\n"))[0].first, 250000);
  EXPECT_EQ(read(folder.file("a.csv", "t [us],v\n3,1\n"))[0].first, 3000);
  EXPECT_EQ(read(folder.file("a.csv", "t [ns],v\n3,1\n"))[0].first, 3);
}

TEST(TableReader, ErrorsNameFileLineAndRemedy) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    return input_error_of(folder, [&] { (void)read(folder.file("a.csv", text)); });
  };
  EXPECT_EQ(error("t,v\n1,2\n2,nan\n"), "a.csv:3: column 'v': 'nan' is not a finite number");
  EXPECT_EQ(error("1,2\n2,inf\n"), "a.csv:2: column 2: 'inf' is not a finite number");
  EXPECT_EQ(error("1,2\n2,fast\n"), "a.csv:2: column 2: 'fast' is not a finite number");
  EXPECT_EQ(error("1,2\n2,\n"), "a.csv:2: column 2: '' is not a finite number");
  EXPECT_EQ(error("1,2\nx,3\n"), "a.csv:2: 'x' is not a time stamp");
  EXPECT_EQ(error("nan,3\n"), "a.csv:1: 'nan' is not a time stamp");
  EXPECT_EQ(error("1,2\n3\n"), "a.csv:2: 1 columns, expected at least 2 separated by commas");
  EXPECT_EQ(error("t,v\n1,19,8\n"),
            "a.csv:2: 3 columns, but the header names 2; do not use decimal commas");
  EXPECT_EQ(error("5,2\n5,3\n"),
            "a.csv:2: time stamp 5 repeats that of line 1; sort the file and remove duplicates");
  EXPECT_EQ(
      error("5,2\n# c\n4,3\n"),
      "a.csv:3: time stamp 4 is earlier than that of line 1; sort the file and remove duplicates");
  EXPECT_EQ(
      error("0.5,2\n"),
      "a.csv:1: time stamp '0.5' is not an integer of nanoseconds; for seconds name the column "
      "'timestamp [s]' in the header");
  EXPECT_EQ(error(""), "a.csv: the file is empty");
  EXPECT_EQ(input_error_of(folder, [&] { (void)read(folder.path() / "none.csv"); }),
            "none.csv: no such file; check the path");
  ASSERT_EQ(mkfifo((folder.path() / "pipe.csv").c_str(), 0600), 0);
  EXPECT_EQ(input_error_of(folder, [&] { (void)read(folder.path() / "pipe.csv"); }),
            "pipe.csv: is a pipe or a device, expected a file");
}

}  // namespace
}  // namespace stillkite
