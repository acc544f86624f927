// Answers Prometheus: GET /metrics on an address of this machine alone, by HTTP. Off without metrics.json.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/base/result.hpp"
#include "common/config/metrics_file.hpp"
#include "common/transport/loop.hpp"

namespace trb::router {

/// At most kMost connections, each for one request of at most kMostBytes within kPatience; who asks for more is cut.
class MetricsPort {
 public:
  static constexpr std::size_t kMost = 8;
  static constexpr std::size_t kMostBytes = 4096;
  static constexpr Duration kPatience = std::chrono::seconds(5);

  /// `text`: what is told, made at each request. Both must outlive it.
  MetricsPort(Loop& loop, std::function<std::string()> text);
  ~MetricsPort();
  MetricsPort(const MetricsPort&) = delete;
  MetricsPort& operator=(const MetricsPort&) = delete;

  /// Errors: io_error, naming the address.
  Status open(const MetricsAddress& at);

 private:
  struct Connection {
    std::string in;
    std::string out;  ///< once the request is there
    MonotonicTime until{};
  };
  void accept();
  void serve(int fd, short revents);
  void read(int fd, Connection& connection);
  void write(int fd, Connection& connection);
  void cut(int fd);
  void cut_late(MonotonicTime now);
  [[nodiscard]] std::optional<MonotonicTime> next() const;

  Loop& loop_;
  std::function<std::string()> text_;
  std::string host_;
  int listener_ = -1;
  std::map<int, Connection> connections_;
};

/// What a request so far is answered with; empty: its head is not complete yet. `host`: "127.0.0.1:9464"; a page that
/// a browser was led to this address by another name is told nothing.
std::string metrics_reply(const std::string& request, const std::string& host,
                          const std::function<std::string()>& text);

}  // namespace trb::router
