#include "services/cloud-gateway/io/drive_desk.hpp"

#include "common/operator/nack_error.hpp"
#include "services/cloud-gateway/io/fresh.hpp"
#include "services/cloud-gateway/io/live_socket.hpp"

namespace trb::gateway {
namespace {

/// A velocity that is older than that is none: the node has ended its drive by then.
constexpr std::uint32_t kCountsFor_ms = 500;
constexpr std::string_view kDriving = "driving";

Result<bool> drive_goes_on(const Message* message) {
  if (message == nullptr) return fail(Errc::timeout, "the robot's node does not answer", "see trb route list");
  if (message->subtype == Nack::kSubtype) {
    const auto nack = decode<Nack>(message->data);
    return nack ? op::nack_error(*nack) : nack.error();
  }
  const auto ack = decode<Ack>(message->data);
  if (!ack) return ack.error();
  return ack->state == kDriving;
}

}  // namespace

Status DriveDesk::drive(const Driver& driver, DriveWord word) {
  Status out = drives_.drive(driver, std::move(word), gateway_.now());
  settle();
  return out;
}

Status DriveDesk::ask(const Driver& driver, const std::string& robot) {
  Status out = drives_.ask(driver, robot, gateway_.now());
  settle();
  return out;
}

void DriveDesk::let_go(ClientId client, const std::string& robot) {
  drives_.let_go(client, robot, gateway_.now());
  settle();
}

void DriveDesk::leave(ClientId client) {
  drives_.leave(client, gateway_.now());
  settle();
}

void DriveDesk::tick(Now now) {
  drives_.tick(now);
  settle();
}

/// Robots first. An order that cannot be sent has effects of its own, so until there are none.
void DriveDesk::settle() {
  for (DriveEffects effects = drives_.take_effects(); !effects.empty(); effects = drives_.take_effects()) {
    for (const DriveOrder& order : effects.orders) send(order);
    note(effects.notes);
    for (const DriveAnswer& one : effects.answers) answer(one);
  }
}

void DriveDesk::send(const DriveOrder& order) {
  const Send send{
      .type = MessageType::command, .target = order.robot, .remaining_ms = kCountsFor_ms, .body = order.velocity};
  const Status sent = gateway_.session.send(send, Drives::kAnswer, [this, order](const Message* message) {
    drives_.answered(order, drive_goes_on(message), gateway_.now());
    settle();
  });
  if (!sent) drives_.answered(order, sent.error(), gateway_.now());
}

void DriveDesk::note(const std::vector<DriveNote>& notes) {
  if (notes.empty()) return;
  std::vector<AuditRecord> records;
  for (const DriveNote& one : notes) {
    AuditRecord record;
    record.time = gateway_.now().utc.ns;
    record.who = one.who;
    record.from = one.from;
    record.action = one.action;
    record.about = one.about;
    record.outcome = one.outcome;
    gateway_.access.note(record);
    records.push_back(std::move(record));
  }
  if (gateway_.commit()) return;
  // The robot was told all the same.
  for (AuditRecord& one : records) static_cast<void>(put_off(gateway_, std::move(one)));
}

void DriveDesk::answer(const DriveAnswer& answer) {
  const auto at = gateway_.sockets.find(answer.client);
  if (at != gateway_.sockets.end()) at->second->send_drive(answer);
}

}  // namespace trb::gateway
