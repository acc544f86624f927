// Starts, sends and decisions with an Idempotency-Key are done once.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "services/cloud-gateway/io/api/call.hpp"
#include "services/cloud-gateway/io/gateway.hpp"

namespace trb::gateway {

/// What the fleet is told nobody takes back: that it begins is on record before.
enum class Acts : std::uint8_t { in_fleet, here };

/// Answers a repeat with what is there now, if the first answer was too long to be kept. Empty: a stand-in says so.
using Again = std::function<void()>;

/// Acts, unless a request with this key was there before: then it gets that one's answer. Without a key it acts.
/// A stop is ordered each time: no key, no answer of an earlier one, and no full table of keys keeps it from robots;
/// nor does a record, which follows once they are told. `effect`: what to look for if the process ends before the
/// answer is on disk.
void do_once(Gateway& gateway, const CallPtr& call, std::string effect, const std::function<void()>& act,
             Acts acts = Acts::in_fleet, const Again& again = nullptr);

/// The same of an order in the fleet: its effect is its path, with what the parameter `of` names. To be called once all
/// that it says is read and found good: what nobody can be told does not begin.
void order_once(Gateway& gateway, const CallPtr& call, std::string_view of, const std::function<void()>& act,
                const Again& again = nullptr);

/// Goes to disk with the next commit; the request's end makes a record of its own.
void note_begin(Gateway& gateway, Call& call);

/// The answer of a call that was done once goes to disk with the audit record. The key of one that was not done is free
/// again.
void keep_answer(Gateway& gateway, const Call& call, const HttpReply& reply);

/// Longer than any request takes: another gateway's that is older has died with it.
constexpr Duration kAbandoned = std::chrono::minutes(2);

/// At the start, and of a shared database now and then: requests of which nobody knows whether they were done get an
/// answer that says so, and a record. `before`: those alone that began before it.
Status settle_unsure(Access& access, UtcTime now, std::optional<UtcTime> before = std::nullopt);

}  // namespace trb::gateway
