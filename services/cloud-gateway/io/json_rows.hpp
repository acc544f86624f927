// Rows as JSON: for the API and for the live stream alike.
#pragma once

#include "services/cloud-gateway/core/live/row.hpp"

namespace trb::gateway {

/// {"kind", "node", "name", "number", "version", "live", "heard", "content"}, of an alert with "alarm"; a removed row:
/// {"kind", "node", "name", "number", "removed": true}.
std::string json_row(const Row& row);
/// The same; of a row that is as it was the last time, it is the same text.
SharedBytes json_of(const Row& row);
/// A value as a robot has sent it: what is no JSON becomes a text.
std::string json_value(const std::string& sent);
std::string json_content(const RowContent& content);
/// ["resilience"]: who tells nothing, so that a row that is missing proves nothing.
std::string json_silent(const RowSources& silent);
/// What people have done with an alert.
std::string json_alarm(const Alarm& alarm);

class JsonRows final : public RowEncoder {
 public:
  Bytes encode(const Row& row) override { return json_row(row); }
};

}  // namespace trb::gateway
