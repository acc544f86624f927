// A mode-adapter that keeps nothing on disk, for the targets of drivers.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "services/mode-adapter/core/adapter_core.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {

/// A robot of that transport, without its commands.
inline adapter::Settings robot_settings(const std::string& id, Mode mode, const std::string& transport,
                                        const std::string& capability) {
  adapter::Settings out;
  out.id = id;
  out.mode = mode;
  out.description.capabilities = {capability};
  out.commands.transport = transport;
  return out;
}

struct AdapterUnderTest {
  explicit AdapterUnderTest(adapter::Settings settings)
      : core(
            std::move(settings), [](bool) { return Status(Done{}); },
            [](const std::vector<adapter::Kept>&) { return Status(Done{}); }) {}

  void connect(Channel channel) { core.on_channel_up(channel, now, out); }
  void hear(Channel channel, BytesView bytes) { core.on_bytes(channel, bytes, now, out); }
  void order(const Inbound& message) { core.on(message, now, out); }
  void pass(Duration time) {
    now.mono = now.mono + time;
    core.tick(now, out);
  }
  /// The robot sends the input in pieces, with time between them.
  void hear_pieces(Channel channel, BytesView input, std::size_t size, Duration between) {
    while (!input.empty()) {
      hear(channel, input.substr(0, size));
      input.remove_prefix(std::min(size, input.size()));
      pass(between);
    }
  }
  /// Whatever the robot sent: a command has one answer, at its deadline at the latest.
  void check_answered(std::uint64_t id) {
    pass(std::chrono::seconds(20));
    const auto answers = std::ranges::count(out.sends, id, &Send::reply_to);
    require(answers == 1, "a command is answered once");
  }

  adapter::ModeAdapterCore core;
  Outbox out;
  Now now{{1'000'000'000}, {0}};
};

}  // namespace trb::fuzz
