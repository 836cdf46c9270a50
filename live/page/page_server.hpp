#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "live/operator/operator_command.hpp"
#include "live/page/page_access.hpp"
#include "live/page/page_address.hpp"

namespace stillkite {

/// Coded image with its number, which ascends.
struct PageImage {
  std::int64_t number = 0;
  std::shared_ptr<const std::vector<std::uint8_t>> jpeg;
};

/// Contents of the page that change. Called on the server's threads, several at once.
struct PageContent {
  /// JSON object; `after`: number of the last sample that the browser has, -1 for none.
  std::function<std::string(std::int64_t after)> state;
  /// Newest image, if its number is above `after`.
  std::function<std::optional<PageImage>(std::int64_t after)> image;
};

/// HTTP server of the operator's page, on its own threads of low priority. The first operator who
/// takes control commands; the others watch.
class PageServer {
 public:
  /// Receives one line for each change of control.
  using Report = std::function<void(const std::string&)>;

  /// `operators` receives the commands and outlives the server; null: the page only shows. Throws
  /// InputError that names live.listen if the address cannot be used.
  PageServer(const PageAddress& address, const PageAccess& access, PageContent content,
             OperatorQueue* operators, Report report);
  /// Ends within a second, in mid-request, too.
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  /// In use; the one of the address unless that is 0.
  [[nodiscard]] int port() const { return port_; }

 private:
  class Http;
  std::unique_ptr<Http> http_;
  int port_ = 0;
};

}  // namespace stillkite
