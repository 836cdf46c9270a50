#include "live/page/page_access.hpp"

#include <gtest/gtest.h>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

constexpr const char* kOwnToken = "0123456789abcdef-token";

PageRequest state_request() {
  return {.method = "GET",
          .path = "/state",
          .host = "127.0.0.1:8080",
          .operator_id = "0123456789abcdef0123456789abcdef"};
}

PageRequest command_request() {
  PageRequest out = state_request();
  out.method = "POST";
  out.path = "/command";
  out.content_length = "20";
  return out;
}

int status_of(const PageRequest& request, const PageAccess& access = {}) {
  const auto refusal = page_refusal(request, access);
  return refusal ? refusal->status : 200;
}

TEST(PageAddress, IsAnAddressWithPort) {
  EXPECT_EQ(parse_page_address("127.0.0.1:8080").port, 8080);
  EXPECT_TRUE(parse_page_address("127.0.0.1:8080").is_loopback);
  EXPECT_TRUE(parse_page_address("localhost:0").is_loopback);
  EXPECT_TRUE(parse_page_address("[::1]:80").is_loopback);
  EXPECT_EQ(parse_page_address("[::1]:80").host, "::1");
  EXPECT_FALSE(parse_page_address("0.0.0.0:80").is_loopback);
  EXPECT_FALSE(parse_page_address("[::]:80").is_loopback);
  for (const char* text :
       {"", "8080", ":8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:80x",
        "drone.example:80", "::1:80", "[127.0.0.1]:80", "127.evil.example:80"}) {
    EXPECT_THROW(static_cast<void>(parse_page_address(text)), InputError) << text;
  }
}

TEST(PageAccess, NeedsATokenBeyondThisMachine) {
  const PageAddress here = parse_page_address("127.0.0.1:1"),
                    open = parse_page_address("0.0.0.0:1");
  EXPECT_FALSE(page_access(here, {}, nullptr).token);
  EXPECT_FALSE(page_access(here, {}, "").token);
  EXPECT_EQ(page_access(here, {}, kOwnToken).token, kOwnToken);
  EXPECT_EQ(page_access(open, {}, kOwnToken).token, kOwnToken);
  EXPECT_THROW(static_cast<void>(page_access(open, {}, nullptr)), InputError);
  EXPECT_THROW(static_cast<void>(page_access(here, "drone.example", nullptr)), InputError);
  EXPECT_THROW(static_cast<void>(page_access(here, {}, "short")), InputError);
}

TEST(PageAccess, AnswersOwnHostsOnly) {
  const PageAccess proxied{.public_host = "Drone.example", .token = std::nullopt};
  PageRequest request = state_request();
  for (const char* host :
       {"127.0.0.1:8080", "localhost:8080", "LOCALHOST", "[::1]:8080", "192.168.1.7:8080"}) {
    request.host = host;
    EXPECT_EQ(status_of(request), 200) << host;
  }
  for (const char* host : {"", "evil.example", "evil.example:8080", "localhost.evil.example",
                           "127.0.0.1.evil.example", "[evil.example]:80", "[", "drone.example"}) {
    request.host = host;
    EXPECT_EQ(status_of(request), 403) << host;
  }
  request.host = "drone.example";
  EXPECT_EQ(status_of(request, proxied), 200);
}

TEST(PageAccess, RefusesOtherOrigins) {
  PageRequest request = command_request();
  for (const char* origin : {"", "http://127.0.0.1:8080", "https://127.0.0.1:8080"}) {
    request.origin = origin;
    EXPECT_EQ(status_of(request), 200) << origin;
  }
  for (const char* origin : {"null", "http://127.0.0.1", "http://127.0.0.1:8081", "file://",
                             "http://evil.example", "http://127.0.0.1:8080.evil.example"}) {
    request.origin = origin;
    EXPECT_EQ(status_of(request), 403) << origin;
  }
}

TEST(PageAccess, ChecksTheTokenExceptForThePagesFiles) {
  const PageAccess access{.public_host = std::nullopt, .token = kOwnToken};
  PageRequest request = state_request();
  EXPECT_EQ(status_of(request, access), 401);
  request.authorization = std::string("Bearer ") + kOwnToken;
  EXPECT_EQ(status_of(request, access), 200);
  request.authorization.back() = 'x';
  EXPECT_EQ(status_of(request, access), 401);
  request.authorization = "Bearer ";
  EXPECT_EQ(status_of(request, access), 401);
  EXPECT_EQ(status_of({.method = "GET", .path = "/", .host = "127.0.0.1"}, access), 200);
  EXPECT_EQ(status_of({.method = "GET", .path = "/page.js", .host = "127.0.0.1"}, access), 200);
}

TEST(PageAccess, KnowsItsPathsAndMethods) {
  PageRequest request = state_request();
  for (const char* path : {"", "/..", "/state/", "/etc/passwd", "/%2e%2e/flight.yaml", "state"}) {
    request.path = path;
    EXPECT_EQ(status_of(request), 404) << path;
  }
  request.path = "/state";
  for (const char* method : {"HEAD", "POST", "PUT", "DELETE", "OPTIONS", "PRI", ""}) {
    request.method = method;
    EXPECT_EQ(status_of(request), 405) << method;
  }
}

TEST(PageAccess, BoundsTheBody) {
  PageRequest request = command_request();
  request.content_length = "1000";
  EXPECT_EQ(status_of(request), 200);
  request.content_length = "1001";
  EXPECT_EQ(status_of(request), 413);
  for (const char* length : {"-1", "x", "99999999999999999999", "1 "}) {
    request.content_length = length;
    EXPECT_EQ(status_of(request), 400) << length;
  }
  request.content_length = "";
  EXPECT_EQ(status_of(request), 411);
  request.content_length = "20";
  request.has_transfer_encoding = true;
  EXPECT_EQ(status_of(request), 411);
  PageRequest get = state_request();
  get.content_length = "1";
  EXPECT_EQ(status_of(get), 400);
  get = state_request();
  get.has_repeated_header = true;
  EXPECT_EQ(status_of(get), 400);
}

TEST(PageAccess, NeedsAnOperator) {
  PageRequest request = state_request();
  for (const char* id :
       {"", "0123", "0123456789ABCDEF0123456789abcdef", "0123456789abcdef0123456789abcdef0"}) {
    request.operator_id = id;
    EXPECT_EQ(status_of(request), 400) << id;
  }
}

}  // namespace
}  // namespace stillkite
