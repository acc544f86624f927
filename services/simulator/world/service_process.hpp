// A service: a real core, and in place of its shell (common/service) the world's bus, disk and clock.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/actor/core.hpp"
#include "services/simulator/world/bus.hpp"
#include "services/simulator/world/core_process.hpp"
#include "services/simulator/world/dice.hpp"

namespace trb::world {

/// A core that is broken on purpose: what passes through its seam is changed, or held back (false).
struct Meddler {
  std::function<bool(const std::string& node, const Send& send)> sends;
  std::function<bool(const std::string& node, const Journal& record)> writes;
};

struct ServiceSettings {
  std::string name;  ///< of the socket; "probe": a person
  std::vector<std::string> subtypes{};
  std::vector<std::string> hears{};
  std::uint64_t instance = 0;
  const Duration* commit = nullptr;                          ///< what writing a step's records takes, now
  std::function<void(const std::vector<Journal>&)> store{};  ///< puts them on disk
  std::function<void()> after_sends{};
  CrashPoint* crash = nullptr;
  std::function<void()> on_crash{};  ///< ends the process: may destroy it
  const Meddler* meddler = nullptr;
};

class ServiceProcess {
 public:
  ServiceProcess(ServiceSettings settings, Core& core, Bus& bus, Events& events, const Clock& clock, Dice& dice);
  ServiceProcess(const ServiceProcess&) = delete;
  ServiceProcess& operator=(const ServiceProcess&) = delete;

  /// Something happens to the core that is no message.
  void step(const std::function<void(Now now, Outbox& out)>& call) { process_.step(call); }
  [[nodiscard]] std::uint64_t malformed() const { return malformed_; }

  std::function<void(const Inbound& message)> on_received;  ///< for whoever watches

 private:
  void send_hello();
  void keep_alive();
  void handle(const Bytes& frame);
  void welcome(const Message& message);
  void deliver(Message message);
  void meddle(Outbox& out) const;
  void send(const Send& send);
  [[nodiscard]] ProcessSettings process_settings();

  ServiceSettings settings_;
  Bus& bus_;
  Events& events_;
  Dice& dice_;
  ConnectionId connection_;
  CoreProcess process_;
  Timer alive_;
  std::string node_;
  std::uint16_t slot_ = 0;
  std::uint16_t count_ = 0;
  std::uint64_t malformed_ = 0;
};

}  // namespace trb::world
