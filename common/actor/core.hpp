// The interface between a core (a pure state machine) and the shell that runs it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/signed.hpp"

namespace trb {

/// What the router reports about the node when it accepts the service.
struct NodeIdentity {
  std::string id;
  Role role{};
  std::uint64_t boot = 0;
};

/// A core. No sockets, threads, files or clock reads: message or time in, an Outbox out.
class Core {
 public:
  Core() = default;
  Core(const Core&) = delete;
  Core& operator=(const Core&) = delete;
  virtual ~Core() = default;

  /// The router has accepted the service, or has accepted it again after either of them restarted.
  virtual void on_welcome(const NodeIdentity& node, Now now, Outbox& out) = 0;
  virtual void on(const Inbound& message, Now now, Outbox& out) = 0;
  /// The deadline has come. May be called early; then it does nothing.
  virtual void tick(Now now, Outbox& out) = 0;
  [[nodiscard]] virtual std::optional<MonotonicTime> next_deadline() const = 0;
};

}  // namespace trb
