#include "services/cloud-gateway/io/http/http_server.hpp"

#include <openssl/ssl.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>

#include "services/cloud-gateway/io/http/connection.hpp"
#include "services/cloud-gateway/io/http/connection_table.hpp"

namespace trb::gateway {
namespace {

using tcp = boost::asio::ip::tcp;
using Problem = boost::system::error_code;
using TlsContext = boost::asio::ssl::context;

/// Before the next accept after one that failed, mostly for want of descriptors: some are free by then, and the loop
/// does not spin.
constexpr Duration kAcceptPause = std::chrono::milliseconds(100);

Error file_fault(const std::string& file, const Problem& problem) {
  return fail(Errc::bad_value, file + ": " + problem.message(), "put a PEM file there that this process may read");
}

Status load_files(TlsContext& tls, const HttpServerSettings& settings) {
  Problem problem;
  // Without this OpenSSL asks at the terminal.
  tls.set_password_callback([](std::size_t, TlsContext::password_purpose) { return std::string(); }, problem);
  if (tls.use_certificate_chain_file(settings.certificate_file, problem))
    return file_fault(settings.certificate_file, problem);
  if (tls.use_private_key_file(settings.key_file, TlsContext::pem, problem))
    return file_fault(settings.key_file, problem);
  if (SSL_CTX_check_private_key(tls.native_handle()) != 1)
    return fail(Errc::bad_value, settings.key_file + ": is not the key of " + settings.certificate_file,
                "put the key beside the certificate that it was made for");
  return Done{};
}

/// TLS 1.2 and 1.3, with OpenSSL's ciphers.
Status configure(TlsContext& tls, const HttpServerSettings& settings) {
  SSL_CTX_set_min_proto_version(tls.native_handle(), TLS1_2_VERSION);
  // A client could make the server do asymmetric work again and again on one connection.
  SSL_CTX_set_options(tls.native_handle(), SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_session_cache_mode(tls.native_handle(), SSL_SESS_CACHE_OFF);
  return load_files(tls, settings);
}

class Server final : public HttpServer, private ConnectionOwner {
 public:
  Server(boost::asio::io_context& loop, HttpServerSettings settings, HttpHandler& handler)
      : loop_(loop),
        settings_(std::move(settings)),
        handler_(handler),
        tls_(TlsContext::tls_server),
        listener_(std::make_shared<Listener>(loop)),
        table_(settings_.max_connections, settings_.max_of_source, settings_.max_of_proxy, settings_.proxies) {}
  ~Server() override;
  Status begin();

  [[nodiscard]] std::uint16_t port() const override { return port_; }
  [[nodiscard]] std::size_t connections() const override { return table_.size(); }
  void stop() override;

 private:
  /// What a pending accept needs, for it ends after the server.
  struct Listener {
    explicit Listener(boost::asio::io_context& loop) : acceptor(loop), pause(loop) {}
    void close();
    tcp::acceptor acceptor;
    boost::asio::steady_timer pause;
    bool is_open = true;
  };
  struct Row {
    std::string source;
    std::shared_ptr<Connection> connection;
  };
  using Rows = std::map<ConnectionId, Row>;

  Status listen();
  void accept();
  void on_accepted(Problem problem, tcp::socket socket);
  void admit(tcp::socket socket);
  [[nodiscard]] bool make_room(const std::string& source);
  Rows::iterator longest_idle(const std::string* source);
  void drop(Rows::iterator row);
  [[nodiscard]] std::vector<std::shared_ptr<Connection>> all() const;

  HttpHandler& handler() override { return handler_; }
  [[nodiscard]] const HttpTimes& times() const override { return settings_.times; }
  [[nodiscard]] bool is_stopping() const override { return !listener_->is_open; }
  void replace(ConnectionId id, std::shared_ptr<Connection> by) override;
  void ended(ConnectionId id) override;

  boost::asio::io_context& loop_;
  HttpServerSettings settings_;
  HttpHandler& handler_;
  TlsContext tls_;
  std::shared_ptr<Listener> listener_;
  std::uint16_t port_ = 0;
  ConnectionTable table_;
  Rows rows_;
  ConnectionId next_id_ = 1;
};

void Server::Listener::close() {
  Problem ignored;
  is_open = false;
  acceptor.close(ignored);
  pause.cancel();
}

Status Server::begin() {
  if (const Status ready = configure(tls_, settings_); !ready) return ready;
  if (const Status listening = listen(); !listening) return listening;
  accept();
  return Done{};
}

Status Server::listen() {
  Problem problem;
  const auto address = boost::asio::ip::make_address(settings_.address, problem);
  if (problem)
    return fail(Errc::bad_value, "address: '" + settings_.address + "' is no number",
                "use an address of this machine, or 0.0.0.0 or :: for all");
  const tcp::endpoint end(address, settings_.port);
  tcp::acceptor& acceptor = listener_->acceptor;
  acceptor.open(end.protocol(), problem);
  if (!problem) acceptor.set_option(tcp::acceptor::reuse_address(true), problem);
  if (!problem) acceptor.bind(end, problem);
  if (!problem) acceptor.listen(tcp::acceptor::max_listen_connections, problem);
  if (!problem) port_ = acceptor.local_endpoint(problem).port();
  if (!problem) return Done{};
  const std::string where = settings_.address + " port " + std::to_string(settings_.port);
  return fail(Errc::io_error, where + ": cannot listen: " + problem.message(),
              "choose an address of this machine and a port that no other program has");
}

void Server::accept() {
  listener_->acceptor.async_accept([this, listener = listener_](Problem problem, tcp::socket socket) {
    if (listener->is_open) on_accepted(problem, std::move(socket));
  });
}

void Server::on_accepted(Problem problem, tcp::socket socket) {
  if (!problem) {
    admit(std::move(socket));
    return accept();
  }
  listener_->pause.expires_after(kAcceptPause);
  listener_->pause.async_wait([this, listener = listener_](Problem) {
    if (listener->is_open) accept();
  });
}

void Server::admit(tcp::socket socket) {
  Problem problem;
  const auto client = socket.remote_endpoint(problem);
  if (problem) return;
  const std::string source = source_of(client.address().to_string());
  if (!make_room(source)) return;
  socket.set_option(tcp::no_delay(true), problem);
  const ConnectionId id = next_id_++;
  const int descriptor = socket.release(problem);
  if (problem) return;
  table_.add(source);
  auto& row = rows_[id] = {source, nullptr};
  row.connection = start_connection(loop_, tls_, *this, {id, descriptor, client.address().is_v6(), source});
}

bool Server::make_room(const std::string& source) {
  const auto room = table_.room_for(source);
  if (room == ConnectionTable::Room::free) return true;
  const auto oldest = longest_idle(room == ConnectionTable::Room::source_full ? &source : nullptr);
  if (oldest == rows_.end()) return false;
  drop(oldest);
  return true;
}

/// Of all, or of one source.
Server::Rows::iterator Server::longest_idle(const std::string* source) {
  auto out = rows_.end();
  for (auto at = rows_.begin(); at != rows_.end(); ++at) {
    if (source != nullptr && at->second.source != *source) continue;
    const auto since = at->second.connection->idle_since();
    if (since && (out == rows_.end() || *since < *out->second.connection->idle_since())) out = at;
  }
  return out;
}

void Server::drop(Rows::iterator row) {
  row->second.connection->abort();
  table_.remove(row->second.source);
  rows_.erase(row);
}

void Server::replace(ConnectionId id, std::shared_ptr<Connection> by) {
  rows_.at(id).connection = std::move(by);
}

void Server::ended(ConnectionId id) {
  const auto row = rows_.find(id);
  if (row == rows_.end()) return;
  table_.remove(row->second.source);
  rows_.erase(row);
}

std::vector<std::shared_ptr<Connection>> Server::all() const {
  std::vector<std::shared_ptr<Connection>> out;
  for (const auto& [id, row] : rows_) out.push_back(row.connection);
  return out;
}

void Server::stop() {
  listener_->close();
  for (const auto& connection : all()) connection->finish();
}

Server::~Server() {
  listener_->close();
  for (const auto& connection : all()) connection->abort();
}

}  // namespace

Result<std::unique_ptr<HttpServer>> HttpServer::open(boost::asio::io_context& loop, const HttpServerSettings& settings,
                                                     HttpHandler& handler) {
  auto server = std::make_unique<Server>(loop, settings, handler);
  if (const Status begun = server->begin(); !begun) return begun.error();
  return std::unique_ptr<HttpServer>(std::move(server));
}

}  // namespace trb::gateway
