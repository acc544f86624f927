// A message whose subtype and data a person gives.
#pragma once

#include <string>

#include "common/operator/session.hpp"

namespace trb::op {

/// The body of a subtype: JSON for a typed one (empty data: every field at its default), the text unchanged for
/// another. Errors: bad_value, too_large, and those of the JSON, with an example of that subtype as the hint.
Result<Body> user_body(const std::string& subtype, const std::string& data);

/// Sends information, which has no answer; a Nack, if any, comes quickly. Errors: those of Session::send, a Nack's.
void send_information(Session& session, const Send& send, const Callback<Done>& done);

}  // namespace trb::op
