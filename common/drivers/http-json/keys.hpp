// The keys of commands.json that only this transport has.
#pragma once

#include <string>
#include <string_view>

#include "common/config/node_config.hpp"
#include "common/drivers/http-json/syntax.hpp"
#include "common/drivers/http-json/wire.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb::drivers {

/// "poll_s", "timeout_s", "hold_s", "body", "cookies", "sign_out", "headers", "tls".
void read_http_json_keys(ObjectReader& vendor, VendorCommands& into);

/// How often values are polled, and how long an answer may take.
struct HttpTiming {
  double poll_s = 0.5;
  double timeout_s = 1;  ///< a stop waits at most this long for the answer in progress
};
HttpTiming http_timing(const VendorCommands& vendor);

HttpBody http_body(const VendorCommands& vendor);
std::string type_of(HttpBody body);
bool keeps_http_cookies(const VendorCommands& vendor);
/// The request that ends the robot's session; empty: none.
std::string http_sign_out(const VendorCommands& vendor);
/// Headers of the robot's own, such as an interface's key.
HttpFields http_headers(const VendorCommands& vendor);

/// Names of headers have no case.
bool same_header(std::string_view one, std::string_view other);

}  // namespace trb::drivers
