#include "live/operator/operator_input.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <fstream>

namespace stillkite {
namespace {

namespace fs = std::filesystem;

class OperatorSocket : public testing::Test {
 protected:
  void SetUp() override { fs::remove(path); }
  void TearDown() override { fs::remove(path); }

  void send(const std::string& text) const {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.c_str(), path.native().size());
    const int sender = socket(AF_UNIX, SOCK_DGRAM, 0);
    EXPECT_EQ(sendto(sender, text.data(), text.size(), 0,
                     reinterpret_cast<const sockaddr*>(&address), sizeof address),
              std::ssize(text));
    close(sender);
  }

  const fs::path path = fs::temp_directory_path() / ("operator_" + std::to_string(getpid()));
};

TEST_F(OperatorSocket, DatagramsBecomeCommandsAndOthersAreCounted) {
  OperatorInput input("unix:" + path.string());
  OperatorQueue queue;
  EXPECT_EQ(input.read_into(queue), 0);
  send(R"({"command": "engage"})");
  send("");
  send("{\"command\": \"mark\", \"note\": \"a\"}\n{\"command\": \"stop\"}\n");
  send("land");
  EXPECT_EQ(input.read_into(queue), 1);
  const auto commands = queue.take();
  ASSERT_EQ(commands.size(), 3U);
  EXPECT_EQ(commands[0].action, OperatorAction::engage);
  EXPECT_EQ(commands[1].note, "a");
  EXPECT_EQ(commands[2].action, OperatorAction::stop);
  EXPECT_FALSE(input.has_ended());
}

TEST_F(OperatorSocket, IsOnlyForThisUserAndRemoved) {
  {
    const OperatorInput input("unix:" + path.string());
    struct stat status {};
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600U);
    EXPECT_THROW(OperatorInput("unix:" + path.string()), InputError);
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(OperatorSocket, IsReplacedOnlyIfItsProcessHasEnded) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.c_str(), path.native().size());
  const int killed = socket(AF_UNIX, SOCK_DGRAM, 0);
  ASSERT_EQ(bind(killed, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_THROW(OperatorInput("unix:" + path.string()), InputError);
  close(killed);
  ASSERT_TRUE(fs::exists(path));
  EXPECT_NO_THROW(OperatorInput("unix:" + path.string()));
  std::ofstream(path) << "a file";
  EXPECT_THROW(OperatorInput("unix:" + path.string()), InputError);
}

TEST_F(OperatorSocket, OtherSourcesAreInputErrors) {
  EXPECT_THROW(OperatorInput("udp://:5000"), InputError);
  EXPECT_THROW(OperatorInput("unix:"), InputError);
  EXPECT_THROW(OperatorInput("unix:" + std::string(200, 'a')), InputError);
  EXPECT_THROW(OperatorInput("unix:/nowhere/operator"), InputError);
}

}  // namespace
}  // namespace stillkite
