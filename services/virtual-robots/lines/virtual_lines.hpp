#pragma once

#include <poll.h>

#include <deque>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "services/virtual-robots/lines/body.hpp"
#include "services/virtual-robots/lines/link.hpp"
#include "services/virtual-robots/lines/session.hpp"
#include "services/virtual-robots/support/console.hpp"
#include "services/virtual-robots/support/robot_clock.hpp"

namespace trb::virtual_robots::lines {

struct Settings {
  Endpoint node;
  std::string source;
  double speed = 1.0;
  double slow_read_s = 0;
  SessionSettings session;
  BodySettings body;
  std::optional<Endpoint> control;
};

/** Link, session and body in one loop. The session uses real time, the body robot time. */
class VirtualLines {
 public:
  explicit VirtualLines(const Settings& settings);

  /** Runs until `end` becomes readable or `quit` is read. */
  void run(const Fd& end);

 private:
  pollfd poll_entry() const;
  void serve_link(short found);
  void read_link();
  void disconnect(std::string_view reason);
  void take_console_line(const std::string& line);
  /** The message that reports it, if the words are a fault. */
  std::optional<Message> take_fault(std::string_view words);
  void clear_faults();
  void say(const Message& message);
  void step();
  void take_session_events();
  void take_body_events();
  void write_link();
  double next_deadline() const;
  bool may_read() const { return !session_.hung() && wall_seconds() >= next_read_; }

  Settings settings_;
  RobotClock clock_;
  Link link_;
  Session session_;
  Body body_;
  Console console_;
  std::deque<Message> held_;
  std::set<std::string> faults_;  ///< the capabilities whose faults were reported
  double next_read_ = 0;
  bool quit_ = false;
};

}  // namespace trb::virtual_robots::lines
