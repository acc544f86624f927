// One request under way, and what answers it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "common/audit/audit_chain.hpp"
#include "proto/value.hpp"
#include "services/cloud-gateway/core/live/idempotency.hpp"
#include "services/cloud-gateway/core/live/problem.hpp"
#include "services/cloud-gateway/io/http/exchange.hpp"

namespace trb::gateway {

/// RFC 9457: {"type", "title", "status", "detail", "errors": [{"pointer", "detail", "hint"}]}.
HttpReply problem_reply(const Problem& problem);
HttpReply problem_reply(const Error& error);
/// A problem of the gateway itself: `code` becomes its type.
HttpReply problem_reply(int status, std::string_view code, const std::string& detail, const std::string& hint);
HttpReply json_reply(std::string json, int status = 200);
HttpReply json_reply(std::shared_ptr<const Bytes> json);
HttpReply empty_reply(int status = 204);

class Call {
 public:
  using Ends = std::function<void(const Call&, HttpReply)>;

  Call(HttpRequest request_in, RequestDecision decision_in, Ends ends)
      : request(std::move(request_in)), decision(std::move(decision_in)), ends_(std::move(ends)) {}

  const HttpRequest request;
  const RequestDecision decision;

  std::string actor;  ///< for the audit log, of a request that signs somebody in

  std::string about;  ///< for the audit log, besides the parameters of the path

  std::string outcome = "done";  ///< for the audit log, unless the answer is a refusal

  std::optional<RequestKey> once;  ///< its answer is kept for repeats with this key
  bool is_not_done = false;        ///< refused for now, and nothing was done: a repeat is tried anew

  bool has_begun = false;  ///< that it begins is on record, and the fleet may have been told

  bool is_replay = false;  ///< answered as the first request with its key was

  [[nodiscard]] const Principal& who() const { return decision.who; }
  /// A parameter of the path: the route has it.
  [[nodiscard]] const std::string& parameter(std::string_view name) const;
  /// A value of the query; empty: not there.
  [[nodiscard]] std::string query(std::string_view name) const;
  /// A whole number of the query. Errors: bad_value.
  [[nodiscard]] Result<std::uint64_t> query_number(std::string_view name, std::uint64_t otherwise,
                                                   std::uint64_t most) const;

  /// Once; later calls do nothing.
  void reply(HttpReply reply);
  void fail(const Error& error);
  [[nodiscard]] bool is_answered() const { return !ends_; }

 private:
  Ends ends_;
};
using CallPtr = std::shared_ptr<Call>;

/// For the audit log: who asks for what, from where; its outcome is still open. `about`: besides the path's parameters.
AuditRecord record_of(const RequestDecision& decision, std::string who, std::string source, const std::string& about,
                      UtcTime now);

/// The request's body as a JSON object. Errors: malformed, too_large, bad_value (no object).
Result<Value> body_of(const Call& call);

}  // namespace trb::gateway
