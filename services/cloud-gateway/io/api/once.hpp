// Starts, sends and decisions with an Idempotency-Key are done once.
#pragma once

#include <functional>
#include <string>

#include "services/cloud-gateway/io/api/call.hpp"
#include "services/cloud-gateway/io/gateway.hpp"

namespace trb::gateway {

/// Acts, unless a request with this key was there before: then it gets that one's answer. Without a key it acts.
/// `effect`: what to look for if the process ends before the answer is on disk.
void do_once(Gateway& gateway, const CallPtr& call, std::string effect, const std::function<void()>& act);

/// The answer of a call that was done once goes to disk with the audit record.
void keep_answer(Gateway& gateway, const Call& call, const HttpReply& reply);

/// At the start: requests of which nobody knows whether they were done get an answer that says so.
Status settle_unsure(Access& access);

}  // namespace trb::gateway
