#include "services/cloud-gateway/core/live/row.hpp"

#include "proto/body.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kRowSize = 64;  ///< of the fields that every row has

Bytes comparable(RunSummary run) {
  run.left_s = 0;
  return encode(RunChanged{std::move(run)});
}
Bytes comparable(RunView run) {
  run.left_s = 0;
  return encode(run);
}

template <class T>
bool same(const T& a, const T& b) {
  if constexpr (std::is_same_v<T, RunSummary> || std::is_same_v<T, RunView>) {
    return comparable(a) == comparable(b);
  } else {
    return a == b;
  }
}

std::size_t size(const std::monostate&) {
  return 0;
}
std::size_t size(const NodeRow& row) {
  return row.state.size() + row.address.size() + row.version.size() + row.via.size() + row.reason.size();
}
std::size_t size(const RobotRow& row) {
  std::size_t out = row.connection.size() + row.detail.size() + row.control.size();
  for (const OutOfUse& one : row.out_of_use) {
    out += one.capability.size() + one.text.size() + one.by.size() + sizeof(OutOfUse);
  }
  for (const RobotValue& one : row.values) out += one.name.size() + one.value.size() + sizeof(RobotValue);
  for (const RobotRowFault& one : row.faults) out += one.capability.size() + one.text.size() + sizeof(RobotRowFault);
  for (const DriveInfo& one : row.drives) {
    out += sizeof(DriveInfo) + one.limits.size() * sizeof(double);
    for (const std::string& axis : one.axes) out += sizeof(std::string) + axis.size();
  }
  return out;
}
std::size_t size(const RunSummary& row) {
  return row.run.size() + row.name.size() + row.waits_for.size() + sizeof(RunSummary);
}
std::size_t size(const SensorInfo& row) {
  return row.name.size() + row.kind.size() + row.identity.size() + row.device.size() + row.detail.size();
}
std::size_t size(const SensorReading& row) {
  return row.sensor.size() + row.identity.size() + row.text.size() + sizeof(SensorReading);
}
std::size_t size(const AlertRow& row) {
  return encode(row.alert).size() + row.alarm.source.size() + row.alarm.shelved_why.size() + sizeof(Alarm);
}
std::size_t size(const TeleopRow& row) {
  return row.holder.size() + row.asked_by.size() + row.kept_for.size() + sizeof(TeleopRow);
}
template <IsBody T>
std::size_t size(const T& row) {
  return encode(row).size();
}

}  // namespace

bool same_content(const RowContent& a, const RowContent& b) {
  if (a.index() != b.index()) return false;
  return std::visit([&b](const auto& one) { return same(one, std::get<std::decay_t<decltype(one)>>(b)); }, a);
}

std::size_t size_of(const RowContent& content) {
  return kRowSize + std::visit([](const auto& one) { return size(one); }, content);
}

}  // namespace trb::gateway
