#include "live/page/control_lease.hpp"

#include <gtest/gtest.h>

#include "live/page/request_rate.hpp"

namespace stillkite {
namespace {

TEST(ControlLease, FirstOperatorCommandsAndTheSecondWatches) {
  ControlLease lease;
  const Timestamp now = from_seconds(100);
  EXPECT_EQ(lease.renew("a", now), ControlHolder::nobody);
  EXPECT_TRUE(lease.take("a", now));
  EXPECT_TRUE(lease.take("a", now));
  EXPECT_FALSE(lease.take("b", now));
  EXPECT_EQ(lease.renew("a", now), ControlHolder::this_operator);
  EXPECT_EQ(lease.renew("b", now), ControlHolder::other_operator);
  lease.give_back("b");
  EXPECT_FALSE(lease.take("b", now));
  lease.give_back("a");
  EXPECT_EQ(lease.renew("a", now), ControlHolder::nobody);
  EXPECT_TRUE(lease.take("b", now));
}

TEST(ControlLease, EndsAfterTenSecondsOfSilence) {
  ControlLease lease;
  EXPECT_TRUE(lease.take("a", from_seconds(0)));
  EXPECT_EQ(lease.renew("a", from_seconds(9)), ControlHolder::this_operator);
  EXPECT_FALSE(lease.take("b", from_seconds(18.9)));
  EXPECT_TRUE(lease.take("b", from_seconds(19.1)));
  EXPECT_EQ(lease.renew("a", from_seconds(19.2)), ControlHolder::other_operator);
}

// Requests of one address that are admitted at one time.
int admitted(RequestRate& rate, const std::string& address, Timestamp now) {
  int out = 0;
  while (out < 1000 && rate.admit(address, now)) ++out;
  return out;
}

TEST(RequestRate, AdmitsABurstThenTheRateOfEachAddress) {
  RequestRate rate;
  EXPECT_EQ(admitted(rate, "192.168.1.2", from_seconds(10)), 200);
  EXPECT_EQ(admitted(rate, "192.168.1.2", from_seconds(10.5)), 50);
  EXPECT_EQ(admitted(rate, "192.168.1.3", from_seconds(10.5)), 200);
  EXPECT_EQ(admitted(rate, "192.168.1.2", from_seconds(100)), 200);
}

TEST(RequestRate, AddressesBeyondTheLimitShareOne) {
  RequestRate rate;
  for (int i = 0; i < 64; ++i) {
    EXPECT_EQ(admitted(rate, std::to_string(i), from_seconds(0)), 200);
  }
  EXPECT_EQ(admitted(rate, "further", from_seconds(0)), 0);
  EXPECT_EQ(admitted(rate, "further", from_seconds(3)), 200);
}

}  // namespace
}  // namespace stillkite
