// The API: each route of core/access/rights with the function that answers it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "services/cloud-gateway/io/api/call.hpp"
#include "services/cloud-gateway/io/gateway.hpp"

namespace trb::gateway {

using Handler = std::function<void(const CallPtr&)>;

/// `act(gateway, call)` as a handler.
template <class Act>
Handler of_gateway(Gateway& gateway, Act act) {
  return [&gateway, act](const CallPtr& call) { act(gateway, call); };
}

/// Filled once, at the start.
class HandlerTable {
 public:
  void add(Method method, std::string_view path, Handler handler) { rows_[{method, path}] = std::move(handler); }
  [[nodiscard]] const Handler* find(const Route& route) const;

 private:
  std::map<std::pair<Method, std::string_view>, Handler> rows_;
};

// Each group adds its routes; the gateway outlives them.
void add_status_routes(Gateway& gateway, HandlerTable& table);
void add_session_routes(Gateway& gateway, HandlerTable& table);
void add_user_routes(Gateway& gateway, HandlerTable& table);
void add_token_routes(Gateway& gateway, HandlerTable& table);
void add_fleet_routes(Gateway& gateway, HandlerTable& table);
void add_robot_routes(Gateway& gateway, HandlerTable& table);
void add_preflight_route(Gateway& gateway, HandlerTable& table);
void add_rank_routes(Gateway& gateway, HandlerTable& table);
void add_scenario_routes(Gateway& gateway, HandlerTable& table);
void add_simulation_routes(Gateway& gateway, HandlerTable& table);
void add_run_routes(Gateway& gateway, HandlerTable& table);
void add_alert_routes(Gateway& gateway, HandlerTable& table);
void add_message_routes(Gateway& gateway, HandlerTable& table);
void add_history_routes(Gateway& gateway, HandlerTable& table);
void add_node_routes(Gateway& gateway, HandlerTable& table);
void add_task_routes(Gateway& gateway, HandlerTable& table);
void add_audit_routes(Gateway& gateway, HandlerTable& table);
void add_policy_routes(Gateway& gateway, HandlerTable& table);
void add_page_routes(HandlerTable& table);

/// For what a handler decides after it has waited for another thread: refresh(), and who asks is checked anew. False:
/// it was answered; he has signed out, or may do it no more.
bool is_still_allowed(Gateway& gateway, const CallPtr& call);

/// Checks each request, calls its function, notes each change in the audit log, and replies once that is on disk.
class Api final : public HttpHandler {
 public:
  explicit Api(Gateway& gateway);

  std::optional<HttpReply> before_body(const HttpRequest& request) override;
  void on_request(HttpRequest request, Reply reply) override;
  std::variant<std::shared_ptr<WebSocketIn>, HttpReply> on_upgrade(const HttpRequest& request) override;
  HttpReply refusal(int status, const std::string& code, const std::string& detail, const std::string& hint) override;
  /// Requests whose answer somebody still has to give.
  [[nodiscard]] bool has_open_calls() const { return open_calls_.use_count() > 1; }

 private:
  void end(const Call& call, HttpReply reply, const Reply& send);
  /// Notes what was done or refused, commits, and counts; the reply may be sent then.
  HttpReply on_record(const RequestDecision& decision, const std::string& who, const std::string& source,
                      HttpReply reply, const std::string& about = {}, const std::string& outcome = "done",
                      bool has_begun = false);
  HttpReply unrecorded(const RequestDecision& decision, std::optional<AuditRecord> record, HttpReply reply,
                       const Error& why, bool has_begun);

  std::optional<RequestDecision> decide(const HttpRequest& request);
  HttpReply counted(HttpReply reply);

  Gateway& gateway_;
  HandlerTable table_;
  std::shared_ptr<const int> open_calls_ = std::make_shared<const int>(0);  ///< each of them holds it
};

}  // namespace trb::gateway
