// What the drivers share whose commands and requests stand in commands.json.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "common/config/node_config.hpp"
#include "common/drivers/driver.hpp"

namespace trb::drivers {

/// `Words`: what a command of commands.json has become.
template <class Words>
class CommandsDriver : public Driver {
 public:
  [[nodiscard]] bool knows(MessageType type, std::string_view subtype) const override {
    if (type == MessageType::command) return commands_.contains(subtype);
    return type == MessageType::request && requests_.contains(subtype);
  }
  /// A robot that answers every command reports the end of each.
  [[nodiscard]] bool tells_end(std::string_view subtype) const override { return commands_.contains(subtype); }
  [[nodiscard]] bool may_be_stopped() const override { return may_be_stopped_; }

 protected:
  using Commands = std::map<std::string, Words, std::less<>>;

  CommandsDriver(std::string own_id, const VendorCommands& vendor, Commands commands = {})
      : own_id_(std::move(own_id)),
        commands_(std::move(commands)),
        requests_(vendor.requests.begin(), vendor.requests.end()) {}

  /// commands.json has no words for a halt.
  static void refuse_halt(Token token, const DriverOut& out) {
    const std::string why = "commands.json has no \"stop\" for this robot: the motion goes on";
    out.refuse("no_stop", why);
    out.emit(Halted{token, false, why});
  }
  /// A value may be asked for by its own name, or by the subtype of its request.
  [[nodiscard]] std::string_view name_of_value(std::string_view name) const {
    const auto request = requests_.find(name);
    return request == requests_.end() ? name : std::string_view(request->second);
  }

  std::string own_id_;
  Commands commands_;                                         ///< by subtype
  std::map<std::string, std::string, std::less<>> requests_;  ///< subtype -> value
  bool may_be_stopped_ = false;
  Token last_ticket_ = 0;
};

}  // namespace trb::drivers
