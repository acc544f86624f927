#include "services/cloud-gateway/io/api/conditional.hpp"

namespace trb::gateway {
namespace {

Result<ConditionalRequest> conditions_of(const HttpRequest& request) {
  ConditionalRequest out;
  if (request.if_none_match) {
    auto condition = parse_condition("If-None-Match", *request.if_none_match);
    if (!condition) return condition.error();
    out.if_none_match = std::move(*condition);
  }
  if (request.if_match) {
    auto condition = parse_condition("If-Match", *request.if_match);
    if (!condition) return condition.error();
    out.if_match = std::move(*condition);
  }
  return out;
}

HttpReply changed_reply() {
  return problem_reply(412, "changed", "it has changed", "read it again");
}

}  // namespace

void reply_tagged(const CallPtr& call, const ETag& tag, HttpReply resource) {
  const auto conditions = conditions_of(call->request);
  if (!conditions) return call->fail(conditions.error());
  const Precondition judged = evaluate(*conditions, tag);
  HttpReply out = judged == Precondition::not_modified ? empty_reply(304)
                  : judged == Precondition::failed     ? changed_reply()
                                                       : std::move(resource);
  out.headers.emplace_back("ETag", text_of(tag));
  call->reply(std::move(out));
}

std::optional<HttpReply> refused_change(const Call& call, const ETag& tag) {
  auto conditions = conditions_of(call.request);
  if (!conditions) return problem_reply(conditions.error());
  conditions->is_read = false;
  conditions->needs_if_match = true;
  const Precondition judged = evaluate(*conditions, tag);
  if (judged == Precondition::proceed) return std::nullopt;
  if (judged == Precondition::required) {
    return problem_reply(428, "if_match_missing", "a change needs the version that was read",
                         "send If-Match with the ETag of the last GET");
  }
  HttpReply out = changed_reply();
  out.headers.emplace_back("ETag", text_of(tag));
  return out;
}

}  // namespace trb::gateway
