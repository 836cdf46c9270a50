#include "live/stream/mailbox.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace stillkite {
namespace {

TEST(Mailbox, NewestValueReplacesTheOlderOne) {
  Mailbox<int> mailbox;
  EXPECT_EQ(mailbox.put(1), std::nullopt);
  EXPECT_EQ(mailbox.put(2), 1);
  EXPECT_EQ(mailbox.take(0), 2);
  EXPECT_EQ(mailbox.take(0), std::nullopt);
}

TEST(Mailbox, ReturnsTheLastValueAfterItIsClosed) {
  Mailbox<int> mailbox;
  mailbox.put(1);
  mailbox.close();
  EXPECT_FALSE(mailbox.is_closed_and_empty());
  EXPECT_EQ(mailbox.take(10), 1);
  EXPECT_TRUE(mailbox.is_closed_and_empty());
}

TEST(Mailbox, WakesTheReader) {
  Mailbox<int> mailbox;
  std::thread writer([&] { mailbox.put(7); });
  EXPECT_EQ(mailbox.take(10), 7);
  writer.join();
}

}  // namespace
}  // namespace stillkite
