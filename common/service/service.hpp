// The public library for services: a service's link to its node's router and its one loop. It runs a core; an
// operator's own Layer 2 service needs nothing else.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/actor/core.hpp"
#include "common/base/result.hpp"

namespace trb {

struct ServiceOptions {
  std::string node_dir;               ///< the node's folder; becomes the working directory
  std::string name;                   ///< as in node.json, for example "scheduler"
  std::vector<std::string> subtypes;  ///< the subtypes that it takes
  std::vector<std::string> hears{};   ///< information that it wants a copy of, even if another service takes it
  bool own_log = true;                ///< log to NODE_DIR/log/NAME.log; false: to standard error
  std::string waits{};  ///< why it does nothing yet, for people, 245 bytes at most; empty: it does its work
};

/// Runs one core. Everything happens on the thread that calls run().
class Service {
 public:
  using Effect = std::function<void(Now, Outbox&)>;

  /// Connects to the node's router (which may start later). Errors: io_error, bad_value.
  static Result<std::unique_ptr<Service>> open(ServiceOptions options);

  Service() = default;
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;
  virtual ~Service() = default;

  /// This process's instance: random, new at each start.
  [[nodiscard]] virtual std::uint64_t instance() const = 0;

  /// Commits the records of one step, behind those of earlier steps that could wait; a failure ends the process,
  /// because nothing may be sent that rests on an unwritten record. What waits is committed after
  /// JournalQueue::kLongest and at an orderly end at the latest.
  virtual void on_journal(std::function<Status(const std::vector<Journal>&)> commit) = 0;
  /// Called after each step, once its records are on disk and its messages are sent: for what the core wants done
  /// besides, at its robot or its worker.
  virtual void after_sends(std::function<void()> carry_out) = 0;

  /// Told to end, the loop takes `begin` as a step, and goes on until `done`, for `longest` at most. For what must
  /// still reach a robot.
  virtual void before_end(Effect begin, std::function<bool()> done, Duration longest) = 0;

  /// Calls `ready` in the loop when the descriptor has any of the poll(2) events. One watch a descriptor; calling again
  /// with other events replaces it.
  virtual void watch(int fd, short events, std::function<void(short revents)> ready) = 0;
  virtual void unwatch(int fd) = 0;
  /// A deadline in addition to the core's: the loop wakes at next() and calls tick().
  virtual void timer(std::function<std::optional<MonotonicTime>()> next, std::function<void(Now)> tick) = 0;

  /// Runs an effect on the core as one step of the loop: journal, sends, what is to be done after them. For io that has
  /// received something.
  virtual void step(const Effect& effect) = 0;

  /// False while messages wait in this process because the router has not read earlier ones. Io that can hold back its
  /// source reads no more meanwhile: beyond a bound what is sent is lost, and the core is given a Nack (queue_full).
  [[nodiscard]] virtual bool has_room() const = 0;
  /// What a person should know of it while it works, with the cure, 255 bytes at most; `trb service list` and the
  /// doctor show it until it is another one. Empty: nothing.
  virtual void set_note(std::string note) = 0;
  /// When the node's router was last heard: less than two seconds ago, if it is there.
  [[nodiscard]] virtual MonotonicTime router_heard() const = 0;

  /// Runs until SIGTERM or SIGINT, or until SIGHUP finds `idle` true (0 = orderly, 75 = asked to start again).
  virtual int run(Core& core, std::function<bool()> idle = {}) = 0;

  /// The same for a program with an event loop of its own: start(); then, until handle_ready() is false, watch
  /// descriptor() for reading, and call handle_ready() when it is readable or when next_deadline() has come.
  virtual void start(Core& core, std::function<bool()> idle = {}) = 0;
  [[nodiscard]] virtual int descriptor() const = 0;
  /// Ask before each wait; the deadline may have passed already. Empty: only the descriptor wakes it.
  [[nodiscard]] virtual std::optional<MonotonicTime> next_deadline() = 0;
  /// Handles what is ready and what is due, and never waits. False once the service has to end: see exit_status().
  virtual bool handle_ready() = 0;
  /// What run() would return.
  [[nodiscard]] virtual int exit_status() const = 0;
};

/// Reads both clocks.
Now now();

}  // namespace trb
