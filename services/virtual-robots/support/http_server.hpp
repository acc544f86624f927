#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "services/virtual-robots/support/tcp_server.hpp"

namespace trb::virtual_robots {

struct HttpRequest {
  std::string method;
  std::string target;
  std::map<std::string, std::string> headers;  ///< by name in lower case
  std::string body;

  /** Empty: there is no such header. */
  std::string header(const std::string& name) const;
};

struct HttpReply {
  unsigned status = 200;
  std::string body;  ///< JSON; empty: none
  std::vector<std::pair<std::string, std::string>> headers{};
};

/** HTTP/1.1 on one port: each request is answered at once. A refused one is printed as `refused STATUS`. */
class HttpServer {
 public:
  using Answer = std::function<HttpReply(const HttpRequest&)>;

  /** Port 0: a free one. Throws std::system_error. */
  HttpServer(const Endpoint& where, Answer answer);
  ~HttpServer();

  std::uint16_t port() const { return server_.port(); }
  void add_to_poll(std::vector<pollfd>& polled) { server_.add_to_poll(polled); }
  void serve(const std::vector<pollfd>& polled);

 private:
  struct Intake;
  void take(TcpServer::Client& client);
  void reply(TcpServer::Client& client, const HttpReply& reply, bool stays);

  Answer answer_;
  TcpServer server_;
  std::map<std::uint64_t, std::unique_ptr<Intake>> intakes_;  ///< by client
};

}  // namespace trb::virtual_robots
