#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "services/virtual-robots/lines/message.hpp"
#include "services/virtual-robots/support/pose.hpp"

namespace trb::virtual_robots::lines {

std::optional<Pose> parse_pose(std::string_view text, char separator);
std::string format_pose(const Pose& pose);

/** Which calls of a skill fail; an empty set means all. */
using Failures = std::map<std::string, std::set<int>>;

struct BodySettings {
  /** Seconds that a skill takes; go_to needs no entry and then drives at 1 m/s. */
  std::map<std::string, double> skills;
  Pose start;
  double battery = 100;
  Failures failures;
};

enum class Reason { busy = 1, stopped = 2, injected = 3, bad_data = 4 };

std::string_view reason_text(Reason reason);

struct Started {
  std::string skill;
  std::string data;
};
struct Done {
  std::string skill;
};
struct Failed {
  std::string skill;
  Reason reason = Reason::busy;
};
struct Answer {
  std::string subtype;
  std::string target;
  std::string data;
};

/** What the body has done or has to send. */
using BodyEvent = std::variant<Started, Done, Failed, Answer>;

/** The robot behind the channel: carries out one skill at a time. `now` is robot time in seconds. */
class Body {
 public:
  explicit Body(BodySettings settings) : settings_(std::move(settings)), from_(settings_.start), to_(from_) {}

  void take(const Message& message, double now);
  void stop(double now);
  void release() { stopped_ = false; }

  /** Ends the running skill when its time has come. */
  void advance(double now);

  std::optional<double> next_deadline() const;
  Pose pose(double now) const;
  double battery(double now) const;
  std::vector<BodyEvent> take_events() { return std::exchange(events_, {}); }

 private:
  struct Run {
    std::string skill;
    double begin = 0;
    double end = 0;
  };

  bool knows(const std::string& skill) const { return skill == "go_to" || settings_.skills.contains(skill); }
  void command(const Message& message, double now);
  void request(const Message& message, double now);
  bool fails(const std::string& skill);
  double duration_of(const std::string& skill) const;
  void halt(double now);
  void emit(BodyEvent event) { events_.push_back(std::move(event)); }

  BodySettings settings_;
  Pose from_;
  Pose to_;
  std::optional<Run> run_;
  bool stopped_ = false;
  double worked_ = 0;
  std::map<std::string, int> calls_;
  std::vector<BodyEvent> events_;
};

}  // namespace trb::virtual_robots::lines
