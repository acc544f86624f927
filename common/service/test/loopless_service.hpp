// The base of tests' own services: what a test drives by hand has no loop.
#pragma once

#include "common/service/service.hpp"

namespace trb {

/// A service that runs no core and takes no records. A test's own adds what its io uses.
class LooplessService : public Service {
 public:
  void on_journal(std::function<Status(const std::vector<Journal>&)>) override {}
  void before_end(Effect, std::function<bool()>, Duration) override {}
  void set_note(std::string) override {}
  [[nodiscard]] bool has_room() const override { return true; }
  [[nodiscard]] MonotonicTime router_heard() const override { return {}; }
  int run(Core&, std::function<bool()>) override { return 0; }
  void start(Core&, std::function<bool()>) override {}
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() override { return std::nullopt; }
  bool handle_ready() override { return false; }
  [[nodiscard]] int exit_status() const override { return 0; }
};

}  // namespace trb
