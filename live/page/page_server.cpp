#include "live/page/page_server.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <thread>
#include <utility>

#include "geometry/fields.hpp"
#include "live/clock/local_clock.hpp"
#include "live/page/control_lease.hpp"
#include "live/page/page_assets.hpp"
#include "live/page/page_connection.hpp"
#include "live/page/request_rate.hpp"

namespace stillkite {
namespace {

constexpr int kMaxPageConnections = 24;

// Of the request and connection that this thread answers.
thread_local std::optional<PageRefusal> request_refusal;
thread_local bool is_connection_refused = false;

// On a loaded machine the estimator goes first. Linux has a priority per thread.
void lower_priority_once() {
  constexpr int kNice = 10;
  thread_local const int result = setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
  static_cast<void>(result);
}

// One thread per connection; connections beyond that are closed at once instead of waiting.
class ConnectionQueue final : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> connection) override {
    if (open_ >= kMaxPageConnections) {
      is_connection_refused = true;
      connection();
      is_connection_refused = false;
      return;
    }
    ++open_;
    threads_.enqueue([this, connection = std::move(connection)] {
      connection();
      --open_;
    });
  }
  void shutdown() override { threads_.shutdown(); }

 private:
  std::atomic<int> open_ = 0;
  httplib::ThreadPool threads_{kMaxPageConnections};
};

PageRequest facts_of(const httplib::Request& request) {
  PageRequest out{.method = request.method,
                  .path = request.path,
                  .host = request.get_header_value("Host"),
                  .origin = request.get_header_value("Origin"),
                  .authorization = request.get_header_value("Authorization"),
                  .operator_id = request.get_header_value("X-Operator"),
                  .content_length = request.get_header_value("Content-Length"),
                  .has_transfer_encoding = request.has_header("Transfer-Encoding")};
  for (const char* name : {"Host", "Origin", "Authorization", "X-Operator", "Content-Length"}) {
    out.has_repeated_header |= request.get_header_value_count(name) > 1;
  }
  return out;
}

std::int64_t number_after(const httplib::Request& request) {
  const std::string text = request.get_param_value("after");
  std::int64_t out = -1;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out;
}

void set_text(httplib::Response& response, int status, const std::string& text) {
  response.status = status;
  response.set_content(text, "text/plain; charset=utf-8");
}

httplib::Headers page_headers() {
  return {{"Content-Security-Policy",
           "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
           "img-src blob: data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          {"X-Content-Type-Options", "nosniff"},
          {"Referrer-Policy", "no-referrer"},
          {"Cache-Control", "no-store"}};
}

}  // namespace

class PageServer::Http final : public httplib::Server {
 public:
  Http(PageAccess access, PageContent content, OperatorQueue* operators, Report report)
      : access_(std::move(access)),
        content_(std::move(content)),
        operators_(operators),
        report_(std::move(report)) {
    new_task_queue = [] { return new ConnectionQueue; };
    set_default_headers(page_headers());
    set_payload_max_length(kMaxPageBody_bytes);
    set_tcp_nodelay(true);
    // the library's default lets two flights share a port
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    set_pre_routing_handler([](const httplib::Request&, httplib::Response& response) {
      if (!request_refusal) return HandlerResponse::Unhandled;
      set_text(response, request_refusal->status, request_refusal->reason);
      return HandlerResponse::Handled;
    });
    set_exception_handler([](const httplib::Request&, httplib::Response& response,
                             const std::exception_ptr&) { set_text(response, 500, "error"); });
    add_routes();
  }

  // Runs until `stop`.
  void start() {
    thread_ = std::thread([this] {
      listen_after_bind();
      has_ended_ = true;
    });
    while (!is_running() && !has_ended_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  void end() {
    stop();
    if (thread_.joinable()) thread_.join();
  }

 private:
  using Request = httplib::Request;
  using Response = httplib::Response;

  void add_routes() {
    const auto add_file = [this](const char* path, std::string_view text, const char* type) {
      Get(path, [text, type](const Request&, Response& response) {
        response.set_content(text.data(), text.size(), type);
      });
    };
    add_file("/", page_assets::kHtml, "text/html; charset=utf-8");
    add_file("/page.css", page_assets::kStyle, "text/css; charset=utf-8");
    add_file("/page.js", page_assets::kScript, "text/javascript; charset=utf-8");
    Get("/state", [this](const Request& request, Response& out) { send_state(request, out); });
    Get("/image", [this](const Request& request, Response& out) { send_image(request, out); });
    Post("/command", [this](const Request& request, Response& out) { command(request, out); });
    Post("/take_control",
         [this](const Request& request, Response& out) { take_control(request, out); });
    Post("/return_control",
         [this](const Request& request, Response& out) { return_control(request, out); });
  }

  bool process_and_close_socket(socket_t socket) override {
    bool is_kept = !is_connection_refused;
    if (is_kept) lower_priority_once();
    PageConnection connection(socket, [this] { return svr_sock_ == INVALID_SOCKET; });
    while (is_kept && connection.wait_for_request()) {
      is_kept = false;
      bool is_closed = false;
      const bool is_sent = process_request(connection, false, is_closed, [&](Request& request) {
        // the body of a refused request is not read: what follows is no request
        is_kept = admit(request) && request.method == "GET";
        if (is_kept) return;
        request.headers.erase("Connection");
        request.set_header("Connection", "close");
      });
      is_kept = is_kept && is_sent && !is_closed;
    }
    shutdown(socket, SHUT_RDWR);
    return close(socket) == 0;
  }

  bool admit(Request& request) {
    // compression costs more than it saves; parts of an answer have no use
    for (const char* name : {"Accept-Encoding", "Range", "Expect"}) request.headers.erase(name);
    request.ranges.clear();
    request_refusal = rate_.admit(request.remote_addr, local_now())
                          ? page_refusal(facts_of(request), access_)
                          : PageRefusal{429, "too many requests"};
    return !request_refusal;
  }

  static std::string operator_of(const Request& request) {
    return request.get_header_value("X-Operator");
  }

  void send_state(const Request& request, Response& response) {
    const ControlHolder holder = lease_.renew(operator_of(request), local_now());
    response.set_content(fmt::format(R"({{"control":"{}","flight":{}}})", name_of(holder),
                                     content_.state(number_after(request))),
                         "application/json");
  }

  void send_image(const Request& request, Response& response) {
    const std::optional<PageImage> image = content_.image(number_after(request));
    response.status = image ? 200 : 204;
    if (!image) return;
    response.set_header("X-Image", std::to_string(image->number));
    response.set_content(reinterpret_cast<const char*>(image->jpeg->data()), image->jpeg->size(),
                         "image/jpeg");
  }

  void command(const Request& request, Response& response) {
    auto command = parse_operator_command(request.body, local_now());
    if (!command) return set_text(response, 400, "no command");
    if (operators_ == nullptr) return set_text(response, 409, "no ground station");
    if (lease_.renew(operator_of(request), local_now()) != ControlHolder::this_operator) {
      return set_text(response, 403, "take control first");
    }
    operators_->push(std::move(*command));
    set_text(response, 202, "accepted");
  }

  void take_control(const Request& request, Response& response) {
    if (operators_ == nullptr) return set_text(response, 409, "no ground station");
    if (!lease_.take(operator_of(request), local_now())) {
      return set_text(response, 403, "another operator has control");
    }
    report_("page: an operator at " + request.remote_addr + " has control");
    set_text(response, 200, "taken");
  }

  void return_control(const Request& request, Response& response) {
    if (lease_.renew(operator_of(request), local_now()) == ControlHolder::this_operator) {
      lease_.give_back(operator_of(request));
      report_("page: the operator has returned control");
    }
    set_text(response, 200, "returned");
  }

  PageAccess access_;
  PageContent content_;
  OperatorQueue* operators_;
  Report report_;
  RequestRate rate_;
  ControlLease lease_;
  std::atomic<bool> has_ended_ = false;
  std::thread thread_;
};

PageServer::PageServer(const PageAddress& address, const PageAccess& access, PageContent content,
                       OperatorQueue* operators, Report report)
    : http_(std::make_unique<Http>(access, std::move(content), operators, std::move(report))),
      port_(address.port) {
  const bool is_bound = address.port == 0 ? (port_ = http_->bind_to_any_port(address.host)) > 0
                                          : http_->bind_to_port(address.host, address.port);
  if (!is_bound) {
    throw InputError(fmt::format("live.listen: {}:{} cannot be used; is another program listening?",
                                 address.host, address.port));
  }
  http_->start();
}

PageServer::~PageServer() {
  http_->end();
}

}  // namespace stillkite
