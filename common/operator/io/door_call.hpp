// Calls a cloud node with a code: one connection, one word, one answer.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/operator/door_answer.hpp"
#include "common/security/join_code.hpp"
#include "common/security/keys.hpp"
#include "common/transport/loop.hpp"
#include "common/transport/monitor.hpp"

namespace trb::op {

/// One call at a time, each at most kDoorWait. The key of the cloud node is the code's: nobody else can answer, and the
/// cloud node answers nobody who cannot prove the code's key. Loop and context must outlive it, and it the loop's use.
class DoorCall {
 public:
  using Done = std::function<void(const DoorAnswer& answer)>;
  DoorCall(Context& context, Loop& loop, JoinCode code, LinkKey caller);
  ~DoorCall();
  DoorCall(const DoorCall&) = delete;
  DoorCall& operator=(const DoorCall&) = delete;

  /// `address`: instead of the code's. `done` is called by the loop, once.
  void call(const std::string& address, const Bytes& word, Done done);

 private:
  void on_event(LinkEvent event);
  void on_frame();
  void send_message();
  void end(DoorAnswer answer);
  void close();

  Context& context_;
  Loop& loop_;
  JoinCode code_;
  LinkKey caller_;
  std::optional<Socket> socket_;
  std::unique_ptr<SocketMonitor> monitor_;
  std::optional<Socket> old_socket_;  ///< of the call before: it is closed when none of its own functions runs
  std::unique_ptr<SocketMonitor> old_monitor_;
  Bytes word_;
  bool connected_ = false;
  std::optional<MonotonicTime> until_;
  Done done_;
};

constexpr Duration kDoorWait = std::chrono::seconds(5);

}  // namespace trb::op
