#include "common/operator/io/bus_session.hpp"

#include <unistd.h>

#include "common/security/keys.hpp"
#include "common/security/rights.hpp"
#include "common/service/version.hpp"
#include "common/transport/socket.hpp"

namespace trb::op {
namespace {

constexpr const char* kProbe = "probe";  ///< the bus's place for such members

}  // namespace

Result<std::unique_ptr<BusSession>> BusSession::open(const std::string& name) {
  return open_at(kProbe, name);
}

Result<std::unique_ptr<BusSession>> BusSession::visit(const std::string& service) {
  return open_at(service, visitor_of(service));
}

Result<std::unique_ptr<BusSession>> BusSession::open_at(const std::string& place, const std::string& name) {
  init_crypto();
  const auto bus = bus_address(place);
  if (!bus) return bus.error();
  return std::unique_ptr<BusSession>(new BusSession(*bus, name));
}

BusSession::BusSession(const BusAddress& bus, const std::string& name)
    : link_(context_, bus, ServiceHello{name, {}, random_u64(), static_cast<std::uint32_t>(::getpid()), kVersion}),
      session_(*this) {
  loop_.add_socket(
      link_.handle(), [this] { drain(); }, link_.unseen());
  loop_.add_timer([this] { return link_.next_deadline(); }, [this](Now now) { link_.tick(now); });
  loop_.add_timer([this] { return session_.next_deadline(); }, [this](Now) { session_.tick(); });
}

const std::string& BusSession::node() const {
  static const std::string kNone;
  return link_.welcome() ? link_.welcome()->node : kNone;
}

Bytes BusSession::random_bytes(std::size_t size) {
  return trb::random_bytes(size);
}

void BusSession::drain() {
  for (int i = 0; i < kTurnMessages; ++i) {
    const auto message = link_.receive(read_clocks());
    if (message) {
      if (!session_.receive(*message) && receiver_) receiver_(*message);
    } else if (!*link_.unseen()) {
      return;
    }
  }
}

}  // namespace trb::op
