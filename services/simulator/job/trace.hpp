// A kept trace of a world: its job, and each message with the event in which it was sent.
#pragma once

#include <string>

#include "services/simulator/job/job.hpp"
#include "services/simulator/world/world.hpp"

namespace trb::simulator {

constexpr std::uint64_t kMaxTraced = 1'000'000;

/// Lines of JSON: first {"job"}, which plays the same again, then a message each, and once it is written {"complete":
/// true, "messages": how many}. With several runs a message has its `run`, 0 for the first; one of none or of several
/// has none. `digest`, of all messages so far, tells whether another run is the same up to there.
class Trace {
 public:
  explicit Trace(const std::string& job_text, std::uint64_t most = kMaxTraced);

  void on(const world::World& world, const world::Sending& sending, CostPhase phase);
  /// All of it or nothing, also when a person interrupts; the last thing that is done with it. Errors: too_large (over
  /// a million messages), of the file.
  [[nodiscard]] Status write(const std::string& path);
  /// It has more messages than a trace may have: it cannot be written any more.
  [[nodiscard]] bool is_too_long() const { return count_ > most_; }
  [[nodiscard]] const Bytes& text() const { return text_; }

 private:
  std::uint64_t most_;
  Bytes text_;
  std::uint64_t count_ = 0;
};

/// Errors: too_large.
Status check_traced(std::uint64_t messages);
/// Can a file be written there? Asked before anything is played. Errors: io_error, naming the path.
Status check_place(const std::string& path);
/// As write_file; Ctrl-C waits until it is done.
Status write_whole(const std::string& path, BytesView text);

std::string digest_text(std::uint64_t digest);

/// The state of a world that has ended behind an event: its messages so far, their digest, each node.
Value state_value(const world::World& world);

}  // namespace trb::simulator
