// Where the bridge's parts put what follows of a step: ends of commands for the mode-adapter, words for the worker.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/actor/core.hpp"
#include "proto/bodies/bridge.hpp"
#include "services/ros-bridge/core/worker_syntax.hpp"

namespace trb::ros {

/// What the core wants done at its worker: bytes to write, and whether to kill it.
struct WorkerOutput {
  Bytes bytes;
  bool kill = false;

  [[nodiscard]] bool empty() const { return bytes.empty() && !kill; }
};

struct BridgeOut {
  const std::string& node;    ///< the own one's id
  std::uint64_t adapter = 0;  ///< the instance of the mode-adapter that gave the commands
  Outbox& outbox;
  WorkerOutput& worker;

  /// The command with that token has been carried out.
  void done(std::uint64_t token) const { event(token, BridgeResult::done, {}, std::nullopt); }
  /// A topic's message for the command with that token, as JSON.
  void value(std::uint64_t token, std::string data) const {
    event(token, BridgeResult::value, std::move(data), std::nullopt);
  }
  /// A watch goes on, but of the topic's newest message it has nothing; counted by the error's code.
  void unknown(std::uint64_t token, const Error& error) const { event(token, BridgeResult::value, {}, error); }
  /// The command with that token has failed; counted by the error's code.
  void failed(std::uint64_t token, const Error& error) const { event(token, BridgeResult::failed, {}, error); }
  void order(Word word, std::vector<Bytes> parts) const { worker.bytes += to_bytes({word, std::move(parts)}); }

 private:
  void event(std::uint64_t token, BridgeResult result, std::string data, const std::optional<Error>& error) const {
    BridgeEvent event{adapter, token, result, std::move(data), {}, {}, {}};
    if (error) {
      event.code = std::string(errc_name(error->code));
      event.what = error->what;
      event.hint = error->hint;
      outbox.count("refused." + event.code);
    }
    outbox.information(node, std::move(event));
  }
};

}  // namespace trb::ros
