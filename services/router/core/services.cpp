#include "services/router/core/services.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "common/base/ids.hpp"
#include "common/security/rights.hpp"
#include "proto/body.hpp"
#include "services/router/core/config.hpp"

namespace trb::router {

Result<std::uint16_t> Services::welcome(ConnectionId connection, const ServiceHello& hello, Member member,
                                        MonotonicTime now) {
  // A Hello sent again, because its answer was slow: requests under way bear the old slot.
  const auto known = connections_.find(connection);
  const bool again = known != connections_.end() && known->second.hello.instance == hello.instance &&
                     known->second.hello.service == hello.service && known->second.member == member;
  const std::uint16_t kept = again ? known->second.slot : 0;
  SentRequests sent = again ? std::move(known->second.sent) : SentRequests{};
  forget(connection);
  if (member == Member::visitor) forget_visitor(hello.service);
  if (Status may = may_come(hello, member); !may) return may.error();
  const std::uint16_t slot = kept != 0 ? kept : free_slot();
  connections_[connection] = {hello, member, slot, now, now, std::move(sent), {}};
  slots_[slot] = connection;
  if (member == Member::service) add_service(connection, hello);
  return slot;
}

/// node.json bounds the number of services; no crowd of probes keeps one of them out.
Status Services::may_come(const ServiceHello& hello, Member member) const {
  if (member != Member::service) {
    if (connections_.size() < kMaxConnections) return Done{};
    return fail(Errc::queue_full, "too many connections on the bus");
  }
  if (holder(hello.service)) return fail(Errc::already_claimed, "service '" + hello.service + "' is running already");
  if (Status may = may_take_subtypes(hello); !may) return may;
  for (const std::string& subtype : hello.hears) {
    if (!is_reserved(subtype)) return fail(Errc::bad_value, "hears: '" + subtype + "' is no word of the middleware");
  }
  return Done{};
}

Status Services::may_take_subtypes(const ServiceHello& hello) const {
  for (const std::string& subtype : hello.subtypes) {
    if (!is_valid_word(subtype)) return fail(Errc::bad_value, "subtypes: '" + subtype + "' is no word");
    if (!may_take(hello.service, subtype))
      return fail(Errc::not_permitted, "subtype '" + subtype + "' is the middleware's own", "hear it: `hears`");
    if (by_subtype(subtype))
      return fail(Errc::already_claimed, "subtype '" + subtype + "' is taken by another service");
  }
  return Done{};
}

/// So that no service's key can fill the bus.
void Services::forget_visitor(const std::string& name) {
  const auto at = std::ranges::find_if(connections_, [&](const auto& row) {
    return row.second.member == Member::visitor && row.second.hello.service == name;
  });
  if (at != connections_.end()) forget(at->first);
}

void Services::add_service(ConnectionId connection, const ServiceHello& hello) {
  services_[hello.service] = connection;
  for (const std::string& subtype : hello.subtypes) subtypes_[subtype] = connection;
  for (const std::string& subtype : std::set<std::string>(hello.hears.begin(), hello.hears.end())) {
    subscribers_[subtype].push_back(connection);
  }
  find_reporters();
}

void Services::find_reporters() {
  const auto connection_of = [this](std::string_view service) {
    const auto at = services_.find(service);
    return at == services_.end() ? nullptr : find(at->second);
  };
  sensor_bus_ = connection_of(kSensorBus);
  mode_adapter_ = connection_of(kModeAdapter);
}

std::uint16_t Services::free_slot() {
  do {
    if (++next_slot_ == 0) next_slot_ = 1;
  } while (slots_.count(next_slot_) != 0);
  return next_slot_;
}

void Services::forget(ConnectionId connection) {
  const auto at = connections_.find(connection);
  if (at == connections_.end()) return;
  slots_.erase(at->second.slot);
  std::erase_if(subtypes_, [&](const auto& row) { return row.second == connection; });
  for (auto& [subtype, connections] : subscribers_) std::erase(connections, connection);
  std::erase_if(subscribers_, [](const auto& row) { return row.second.empty(); });
  std::erase_if(services_, [&](const auto& row) { return row.second == connection; });
  connections_.erase(at);
  find_reporters();
}

void Services::on_received(ConnectionId connection, MonotonicTime now) {
  if (const auto at = connections_.find(connection); at != connections_.end()) at->second.last_heard = now;
}

void Services::on_note(ConnectionId connection, const std::string& note) {
  if (const auto at = connections_.find(connection); at != connections_.end()) at->second.note = note;
}

const Connection* Services::find(ConnectionId connection) const {
  const auto at = connections_.find(connection);
  return at == connections_.end() ? nullptr : &at->second;
}

SentRequests* Services::sent_by(ConnectionId connection) {
  const auto at = connections_.find(connection);
  return at == connections_.end() ? nullptr : &at->second.sent;
}

std::optional<ConnectionId> Services::holder(std::string_view service) const {
  const auto at = services_.find(service);
  return at == services_.end() ? std::nullopt : std::optional(at->second);
}

std::optional<ConnectionId> Services::by_subtype(std::string_view subtype) const {
  const auto at = subtypes_.find(subtype);
  return at == subtypes_.end() ? std::nullopt : std::optional(at->second);
}

const std::vector<ConnectionId>& Services::subscribers(std::string_view subtype) const {
  static const std::vector<ConnectionId> kNobody;
  if (subscribers_.empty()) return kNobody;
  const auto at = subscribers_.find(subtype);
  return at == subscribers_.end() ? kNobody : at->second;
}

std::optional<ConnectionId> Services::by_slot(std::uint16_t slot) const {
  const auto at = slots_.find(slot);
  return at == slots_.end() ? std::nullopt : std::optional(at->second);
}

}  // namespace trb::router
