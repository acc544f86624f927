// Carries out what driving asks for: commands to robots' nodes, records in the audit log, answers to clients.
#pragma once

#include "services/cloud-gateway/core/live/drives.hpp"
#include "services/cloud-gateway/io/gateway.hpp"

namespace trb::gateway {

class DriveDesk {
 public:
  /// The gateway must outlive it.
  explicit DriveDesk(Gateway& gateway) : gateway_(gateway), drives_(gateway.book) {}
  DriveDesk(const DriveDesk&) = delete;
  DriveDesk& operator=(const DriveDesk&) = delete;

  /// The caller has checked that the client may drive. Errors: those of Drives.
  Status drive(const Driver& driver, DriveWord word);
  Status ask(const Driver& driver, const std::string& robot);
  void let_go(ClientId client, const std::string& robot);
  void leave(ClientId client);
  void tick(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return drives_.next_deadline(); }

 private:
  void settle();
  void send(const DriveOrder& order);
  void note(const std::vector<DriveNote>& notes);
  void answer(const DriveAnswer& answer);

  Gateway& gateway_;
  Drives drives_;
};

}  // namespace trb::gateway
