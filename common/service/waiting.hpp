// A service whose files cannot be opened yet, as on a full disk: it is there, so that its node can be seen and stopped;
// who sends to it is told why it refuses; and it tries again by itself.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "common/actor/core.hpp"
#include "common/base/result.hpp"
#include "common/service/service.hpp"

namespace trb {

/// Refuses every command and request, with no_service and this reason, and reads nothing else: whoever owes it
/// something sends it again.
class WaitingCore final : public Core {
 public:
  explicit WaitingCore(Error why) : why_(std::move(why)) {}
  void on_welcome(const NodeIdentity&, Now, Outbox&) override {}
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now, Outbox&) override {}
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override { return std::nullopt; }

 private:
  Error why_;
};

/// The reason as its router gets it and notes it for people: with the cure, as long as a note may be.
std::string waits_of(const Error& why);

/// What a service does with a disk that has next to no room: `needed`: it waits, for its files would be full at its
/// first record; `not_needed`: it opens them, for there is much that it can do without writing.
enum class Room : std::uint8_t { needed, not_needed };

/// Calls `open` until it is done; if that fails with io_error, or the disk of the node's folder lacks the room that is
/// needed, the service waits, and tries again every second. Nothing: it is open; a status: the process was asked to end
/// meanwhile. Errors: every other one of `open`, those of Service::open.
Result<std::optional<int>> wait_for_files(const ServiceOptions& options, const std::function<Status()>& open,
                                          Room room = Room::needed);

}  // namespace trb
