// The gateway's parts on one thread: HTTP, the bus, an operator's session, the database.
#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>
#include <vector>

#include "common/log/log.hpp"
#include "common/operator/io/bus_session.hpp"
#include "common/operator/io/tap.hpp"
#include "common/service/service.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/gateway_core.hpp"
#include "services/cloud-gateway/io/http/http_server.hpp"
#include "services/cloud-gateway/io/sign_ins.hpp"

namespace trb::gateway {

class Process {
 public:
  Process(Service& service, GatewayDb& db, std::unique_ptr<HistoryStore> history, Access& access, std::string node_dir,
          Places places, UtcTime certificate_ends);
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Until it is told to end, or the database cannot be written (1). Errors: those of HttpServer::open and
  /// BusSession::open.
  Result<int> run(const HttpServerSettings& server, const std::vector<std::string>& origins);

 private:
  Gateway gateway_of(op::Session& session);
  void add_timers(Gateway& gateway, SignIns& sign_ins);
  Result<std::unique_ptr<op::Tap>> open_tap(op::BusSession& person);
  bool on_passed(const op::TapRecord& record);
  void drive(op::BusSession& person);
  void answer_last(op::BusSession& person, const Api& api);
  void pump(Gateway& gateway);
  void follow_topics(Now now);
  void record(Gateway& gateway, Now now);
  void write_history(Gateway& gateway);
  void try_again(Gateway& gateway, Now now);
  [[nodiscard]] std::string note_of(const Gateway& gateway) const;
  void keep_house(Gateway& gateway, Now now);
  void warn_of_certificate(Now now);
  void end_unwritten(const Error& error);

  Service& service_;
  GatewayDb& db_;
  Access& access_;
  std::string node_dir_;
  Places places_;
  UtcTime certificate_ends_;
  boost::asio::io_context loop_{1};
  PasswordPool passwords_;
  RowBook book_;
  FleetView view_;
  JsonRows encoder_;
  Subscriptions clients_;
  MessageLog messages_;
  HistoryRecorder recorder_;
  HistoryDesk history_;
  std::optional<Error> history_lost_;    ///< why it could not be written last
  std::optional<Error> history_unread_;  ///< why it could not be read last
  RateLimit left_out_lines_{5, std::chrono::minutes(1)};
  RateLimit lost_lines_{5, std::chrono::minutes(1)};
  GatewayCore core_;
  MonotonicTime house_kept_;
  MonotonicTime tried_;                  ///< when it tried last what a full disk has refused
  MonotonicTime looked_;                 ///< when it looked last at what other gateways have written
  MonotonicTime checked_;                ///< when it looked last who may go on to see the fleet
  std::optional<MonotonicTime> warned_;  ///< of the certificate's end
  bool unwritten_ = false;
};

}  // namespace trb::gateway
