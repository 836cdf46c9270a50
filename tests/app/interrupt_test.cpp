#include "app/interrupt.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <thread>

#include "../io/temporary_folder.hpp"

namespace stillkite {
namespace {

// Pipe without a writer; a late writer prevents an endless wait on failure.
TEST(Interrupt, InterruptsBlockedOpen) {
  using std::chrono::milliseconds;
  const TemporaryFolder folder;
  const std::filesystem::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  catch_interrupts();
  std::thread other([&pipe, waiting = pthread_self()] {
    std::this_thread::sleep_for(milliseconds(100));
    pthread_kill(waiting, SIGINT);
    std::this_thread::sleep_for(milliseconds(500));
    close(open(pipe.c_str(), O_RDWR | O_NONBLOCK));
  });
  errno = 0;
  const int descriptor = open(pipe.c_str(), O_RDONLY);
  const int error = errno;
  other.join();
  EXPECT_LT(descriptor, 0);
  EXPECT_EQ(error, EINTR);
  EXPECT_TRUE(interrupted());
}

}  // namespace
}  // namespace stillkite
