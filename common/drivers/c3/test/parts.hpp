// A single part of the C3 driver: a link whose requests the test sees and answers, and the part's events.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "common/drivers/c3/link.hpp"
#include "common/drivers/c3/poll_times.hpp"

namespace trb::drivers {

struct PartsFixture {
  Now now;
  Outbox outbox;
  RobotOutbox robot;
  std::vector<EventFrom> events;
  DriverOut out{nullptr, outbox, robot, events};
  C3Link link;
  C3PollTimes polls;

  /// Sent since the last call: "VARIABLE" for a read, "VARIABLE=VALUE" for a write, each followed by a space.
  std::string sent() {
    std::string all;
    for (const RobotWrite& write : std::exchange(robot.writes, {})) {
      const std::string& bytes = write.bytes;
      const auto size = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at + 1]); };
      const std::string name = bytes.substr(7, size(5));
      tags_.push_back(size(0));
      all += name + (bytes[4] == 1 ? "=" + bytes.substr(9 + name.size()) : "") + " ";
    }
    return all;
  }
  /// The robot answers the oldest request.
  C3Link::Answer answer(const std::string& value, bool ok = true) {
    sent();
    REQUIRE_FALSE(tags_.empty());
    const std::uint16_t tag = tags_.front();
    tags_.erase(tags_.begin());
    return *link.take({tag, value, static_cast<std::uint16_t>(ok ? 1 : 7), ok}, now, out);
  }

  /// The events of that kind since the last call for it.
  template <class Event>
  std::vector<Event> told() {
    std::vector<Event> all;
    for (const EventFrom& each : events) {
      if (const Event* event = std::get_if<Event>(&each.event)) all.push_back(*event);
    }
    std::erase_if(events, [](const EventFrom& each) { return std::holds_alternative<Event>(each.event); });
    return all;
  }

 private:
  std::vector<std::uint16_t> tags_;
};

}  // namespace trb::drivers
