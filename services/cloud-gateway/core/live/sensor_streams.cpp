#include "services/cloud-gateway/core/live/sensor_streams.hpp"

namespace trb::gateway {
namespace {

SensorWatch order_of(const SensorId& sensor, std::uint64_t number, double lease_s) {
  return {sensor.name, "", number, SensorStreams::kEvery_s, lease_s};
}

}  // namespace

void SensorStreams::on_welcome(Now now) {
  for (auto& [sensor, stream] : streams_) stream = {++last_, now.mono};
}

std::vector<SensorId> SensorStreams::want(const std::set<SensorId>& wanted, Now now) {
  std::vector<SensorId> over;
  for (auto at = streams_.begin(); at != streams_.end();) {
    if (wanted.contains(at->first)) {
      ++at;
      continue;
    }
    over.push_back(at->first);
    if (at->second.is_ordered) ended_.emplace_back(at->first, at->second.number);
    at = streams_.erase(at);
  }
  for (const SensorId& sensor : wanted) {
    if (streams_.contains(sensor) || streams_.size() == kMaxStreams) continue;
    streams_[sensor] = {++last_, now.mono};
  }
  return over;
}

void SensorStreams::tick(Now now, Outbox& out) {
  for (const auto& [sensor, number] : std::exchange(ended_, {})) {
    out.request(sensor.node, order_of(sensor, number, 0));
  }
  for (auto& [sensor, stream] : streams_) {
    if (stream.at <= now.mono) drive(sensor, stream, now, out);
  }
}

void SensorStreams::drive(const SensorId& sensor, Stream& stream, Now now, Outbox& out) {
  if (!may_order(sensor)) {
    stream.at = now.mono + kLook;
    stream.is_doubtful = stream.is_ordered;
    return;
  }
  if (std::exchange(stream.is_doubtful, false)) {
    out.request(sensor.node, order_of(sensor, stream.number, 0));
    stream.number = ++last_;
  }
  stream.is_ordered = true;
  stream.at = now.mono + kRenew;
  out.request(sensor.node, order_of(sensor, stream.number, kLease_s));
}

/// A camera gives pictures one by one, on request.
bool SensorStreams::may_order(const SensorId& sensor) const {
  const Row* row = book_.find({RowKind::sensor, sensor.node, sensor.name});
  return row != nullptr && row->live == Live::live && std::get<SensorInfo>(row->content).kind != "image";
}

std::optional<MonotonicTime> SensorStreams::next_deadline() const {
  if (!ended_.empty()) return MonotonicTime{};
  std::optional<MonotonicTime> out;
  for (const auto& [sensor, stream] : streams_) out = earlier(out, stream.at);
  return out;
}

}  // namespace trb::gateway
