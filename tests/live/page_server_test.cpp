#include "live/page/page_server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <thread>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kFirst = "00000000000000000000000000000001";
constexpr const char* kSecond = "00000000000000000000000000000002";

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// TCP connection of a client to this machine.
class ClientSocket {
 public:
  explicit ClientSocket(int port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~ClientSocket() { close(socket_); }
  ClientSocket(const ClientSocket&) = delete;
  ClientSocket& operator=(const ClientSocket&) = delete;

  // False once the server has closed.
  [[nodiscard]] bool send(const std::string& text) const {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == std::ssize(text);
  }
  // All bytes until the server closes, or is silent for `silence_s`.
  [[nodiscard]] std::string receive(double silence_s) const {
    std::string out;
    std::array<char, 4096> bytes{};
    while (true) {
      pollfd ready{.fd = socket_, .events = POLLIN, .revents = 0};
      if (poll(&ready, 1, static_cast<int>(1e3 * silence_s)) <= 0) return out;
      const ssize_t size = recv(socket_, bytes.data(), bytes.size(), 0);
      if (size <= 0) return out;
      out.append(bytes.data(), static_cast<std::size_t>(size));
    }
  }

 private:
  int socket_;
};

class PageServerTest : public testing::Test {
 protected:
  [[nodiscard]] std::string answer(const std::string& request) const {
    const ClientSocket client(server.port());
    EXPECT_TRUE(client.send(request));
    return client.receive(8);
  }
  [[nodiscard]] std::string get(const std::string& target, const char* id = kFirst) const {
    return answer("GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:80\r\nX-Operator: " + id +
                  "\r\nConnection: close\r\n\r\n");
  }
  [[nodiscard]] std::string post(const std::string& target, const std::string& body,
                                 const char* id = kFirst) const {
    return answer("POST " + target + " HTTP/1.1\r\nHost: 127.0.0.1:80\r\nX-Operator: " + id +
                  "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  }
  static int status_of(const std::string& answer) {
    return answer.size() < 12 ? 0 : std::stoi(answer.substr(9, 3));
  }

  OperatorQueue operators;
  std::vector<std::string> reports;
  PageServer server{
      parse_page_address("127.0.0.1:0"),
      {},
      {.state = [](std::int64_t after) { return R"({"after":)" + std::to_string(after) + "}"; },
       .image = [](std::int64_t after) -> std::optional<PageImage> {
         if (after >= 7) return std::nullopt;
         return PageImage{.number = 7,
                          .jpeg = std::make_shared<const std::vector<std::uint8_t>>(3, 'j')};
       }},
      &operators,
      [this](const std::string& line) { reports.push_back(line); }};
};

TEST_F(PageServerTest, SendsFilesStateAndImage) {
  const std::string page = get("/");
  EXPECT_EQ(status_of(page), 200);
  EXPECT_NE(page.find("<title>Stillkite"), std::string::npos);
  EXPECT_NE(page.find("Content-Security-Policy: default-src 'none'"), std::string::npos);
  EXPECT_NE(get("/page.js").find("pollState"), std::string::npos);
  EXPECT_NE(get("/page.css").find("#alarms"), std::string::npos);
  EXPECT_NE(get("/state?after=5").find(R"({"control":"nobody","flight":{"after":5}})"),
            std::string::npos);
  EXPECT_NE(get("/state?after=x").find(R"({"after":-1})"), std::string::npos);
  const std::string image = get("/image?after=6");
  EXPECT_NE(image.find("X-Image: 7\r\n"), std::string::npos);
  EXPECT_TRUE(image.ends_with("\r\n\r\njjj"));
  EXPECT_EQ(status_of(get("/image?after=7")), 204);
}

TEST_F(PageServerTest, FirstOperatorCommandsAndTheSecondWatches) {
  const std::string engage = R"({"command": "engage"})";
  EXPECT_EQ(status_of(post("/command", engage)), 403);
  EXPECT_EQ(status_of(post("/take_control", "")), 200);
  EXPECT_EQ(status_of(post("/take_control", "", kSecond)), 403);
  EXPECT_EQ(status_of(post("/command", engage, kSecond)), 403);
  EXPECT_TRUE(operators.take().empty());
  EXPECT_EQ(status_of(post("/command", engage)), 202);
  EXPECT_EQ(status_of(post("/command", R"({"command": "mark", "note": "rain"})")), 202);
  EXPECT_EQ(status_of(post("/command", R"({"command": "land"})")), 400);
  EXPECT_EQ(status_of(post("/command", "")), 400);
  const std::vector<OperatorCommand> commands = operators.take();
  ASSERT_EQ(commands.size(), 2U);
  EXPECT_EQ(commands[0].action, OperatorAction::engage);
  EXPECT_EQ(commands[1].note, "rain");
  EXPECT_NE(get("/state", kSecond).find(R"("control":"other_operator")"), std::string::npos);
  EXPECT_EQ(status_of(post("/return_control", "")), 200);
  EXPECT_EQ(status_of(post("/take_control", "", kSecond)), 200);
  ASSERT_EQ(reports.size(), 3U);
  EXPECT_EQ(reports[0], "page: an operator at 127.0.0.1 has control");
}

TEST_F(PageServerTest, RefusesForeignRequestsAndCloses) {
  const std::string foreign =
      "POST /take_control HTTP/1.1\r\nHost: 127.0.0.1:80\r\nX-Operator: " + std::string(kFirst) +
      "\r\nContent-Length: 0\r\n";
  EXPECT_EQ(status_of(answer(foreign + "Origin: http://evil.example\r\n\r\n")), 403);
  EXPECT_EQ(status_of(answer("GET /state HTTP/1.1\r\nHost: evil.example\r\n\r\n")), 403);
  EXPECT_EQ(status_of(get("/../flight.yaml")), 404);
  EXPECT_EQ(status_of(get("/%2e%2e/flight.yaml")), 404);
  EXPECT_EQ(status_of(answer("OPTIONS /command HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")), 405);
  // the body of a refused request is not taken for the next request
  const std::string inner = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n";
  const std::string smuggled =
      answer("GET /state HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 40\r\n\r\n" + inner);
  EXPECT_EQ(status_of(smuggled), 400);
  EXPECT_EQ(smuggled.find("<title>"), std::string::npos);
  EXPECT_TRUE(operators.take().empty());
}

TEST_F(PageServerTest, BoundsTheSizeOfARequest) {
  EXPECT_EQ(status_of(post("/command", std::string(1001, 'x'))), 413);
  EXPECT_EQ(status_of(get("/" + std::string(9000, 'x'))), 414);
  // headers without end
  const ClientSocket client(server.port());
  const std::string header = "X-Further: " + std::string(500, 'x') + "\r\n";
  bool is_open = client.send("GET / HTTP/1.1\r\n");
  for (int i = 0; i < 10'000 && is_open; ++i) is_open = client.send(header);
  EXPECT_FALSE(is_open);
  EXPECT_EQ(status_of(get("/state")), 200);
}

TEST_F(PageServerTest, BoundsTheTimeOfARequest) {
  const auto start = Clock::now();
  const ClientSocket client(server.port());
  EXPECT_TRUE(client.send("GET /state HTTP/1.1\r\n"));
  while (seconds_since(start) < 20 && client.send("X")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  EXPECT_GT(seconds_since(start), 4);
  EXPECT_LT(seconds_since(start), 8);
}

TEST_F(PageServerTest, BoundsTheNumberOfConnections) {
  std::vector<std::unique_ptr<ClientSocket>> idle;
  idle.reserve(24);
  for (int i = 0; i < 24; ++i) idle.push_back(std::make_unique<ClientSocket>(server.port()));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(ClientSocket(server.port()).receive(2), "");
}

TEST_F(PageServerTest, BoundsTheRateOfRequests) {
  std::string requests;
  for (int i = 0; i < 200; ++i) {
    requests +=
        std::string("GET /state HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Operator: ") + kFirst + "\r\n\r\n";
  }
  const auto answered = [&] {
    const ClientSocket client(server.port());
    EXPECT_TRUE(client.send(requests));
    const std::string answers = client.receive(1);
    int out = 0;
    for (auto at = answers.find("HTTP/1.1 200"); at != std::string::npos;
         at = answers.find("HTTP/1.1 200", at + 1)) {
      ++out;
    }
    return out;
  };
  EXPECT_EQ(answered(), 200);
  // one second has passed since
  EXPECT_LT(answered(), 200);
}

TEST_F(PageServerTest, KeepsAConnectionForFurtherRequests) {
  const ClientSocket client(server.port());
  const std::string request =
      std::string("GET /state HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Operator: ") + kFirst + "\r\n\r\n";
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(client.send(request));
    EXPECT_EQ(status_of(client.receive(0.5)), 200);
  }
}

TEST_F(PageServerTest, PortInUseIsAnInputError) {
  const std::string address = "127.0.0.1:" + std::to_string(server.port());
  EXPECT_THROW(PageServer(parse_page_address(address), {}, {}, nullptr, [](auto&&...) {}),
               InputError);
}

TEST(PageServer, EndsInMidRequest) {
  auto server =
      std::make_unique<PageServer>(parse_page_address("127.0.0.1:0"), PageAccess{},
                                   PageContent{.state = [](std::int64_t) { return "{}"; },
                                               .image = [](std::int64_t) { return std::nullopt; }},
                                   nullptr, [](auto&&...) {});
  const ClientSocket client(server->port()), idle(server->port());
  EXPECT_TRUE(client.send("GET /state HTTP/1.1\r\nHost: 127"));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto start = Clock::now();
  server.reset();
  EXPECT_LT(seconds_since(start), 1);
}

}  // namespace
}  // namespace stillkite
