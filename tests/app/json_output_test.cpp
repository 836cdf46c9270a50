#include "app/json_output.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <csignal>

namespace stillkite {
namespace {

// Standard output is a pipe while the object exists.
class OutputPipe {
 public:
  OutputPipe() : saved_(dup(STDOUT_FILENO)) {
    std::array<int, 2> ends{};
    EXPECT_EQ(pipe(ends.data()), 0);
    reader_ = ends[0];
    dup2(ends[1], STDOUT_FILENO);
    close(ends[1]);
  }
  ~OutputPipe() {
    dup2(saved_, STDOUT_FILENO);
    close(saved_);
    close_reader();
  }
  OutputPipe(const OutputPipe&) = delete;
  OutputPipe& operator=(const OutputPipe&) = delete;

  void close_reader() {
    if (reader_ >= 0) close(reader_);
    reader_ = -1;
  }

 private:
  int saved_, reader_ = -1;
};

TEST(JsonOutput, DropsLinesThatNobodyReads) {
  const OutputPipe output;
  JsonOutput json("-");
  for (int i = 0; i < 200; ++i) EXPECT_TRUE(json.send({}));
  EXPECT_GT(json.dropped(), 0);
}

TEST(JsonOutput, ReportsAClosedReader) {
  std::signal(SIGPIPE, SIG_IGN);
  OutputPipe output;
  JsonOutput json("-");
  EXPECT_TRUE(json.send({}));
  output.close_reader();
  EXPECT_FALSE(json.send({}));
}

}  // namespace
}  // namespace stillkite
