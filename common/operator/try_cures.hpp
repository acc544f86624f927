// What to put right, and where, when a robot does not do what it must.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.hpp"
#include "proto/bodies/link.hpp"

namespace trb::op {

/// It is not connected: by its transport.
std::string cure_of_connection(const NodeProfile& profile);
/// It does not answer a request of that word, or says no number.
std::string cure_of_request(const NodeProfile& profile, const std::string& word, std::string_view code);
/// A skill has not ended well; `reason` is what its task says.
std::string cure_of_skill(const NodeProfile& profile, const std::string& skill, const std::string& reason);
/// Somebody commands it.
std::string cure_of_control(const NodeProfile& profile);
/// `stop` or `release` was not confirmed.
std::string cure_of_order(const NodeProfile& profile, const std::string& order);

}  // namespace trb::op
