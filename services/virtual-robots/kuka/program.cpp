#include "services/virtual-robots/kuka/program.hpp"

#include <algorithm>
#include <utility>

#include "services/virtual-robots/kuka/text.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::kuka {
namespace {

constexpr std::size_t kRoom = 64;       ///< of the short texts
constexpr std::size_t kDataRoom = 128;  ///< of the data
constexpr std::size_t kMostSayings = 64;
// The result of its camera.
constexpr const char* kSeen = R"({"place":"table1"})";
// The result of a message: TRB_RESULT.
constexpr int kWell = 0;
constexpr int kStopped = 2;
constexpr int kInjected = 3;
constexpr int kBadData = 4;
constexpr int kUnknown = 5;

std::string krl(bool flag) {
  return flag ? "TRUE" : "FALSE";
}

arm::Joints first_six(const std::vector<double>& numbers) {
  arm::Joints out{};
  std::copy_n(numbers.begin(), arm::kAxes, out.begin());
  return out;
}

}  // namespace

Program::Program(std::vector<Failure> failures) : failures_(std::move(failures)), calls_(failures_.size(), 0) {
  declare_variables();
}

void Program::declare_variables() {
  Variables& v = variables_;
  for (const char* name :
       {"TRB_TYPE", "TRB_SUBTYPE", "TRB_SOURCE", "TRB_OUT_TYPE", "TRB_OUT_SUBTYPE", "TRB_OUT_TARGET"}) {
    v.declare(name, Type::text, "", kRoom);
  }
  for (const char* name : {"TRB_DATA", "TRB_OUT_DATA", "TRB_TEXT", "TRB_ERROR"})
    v.declare(name, Type::text, "", kDataRoom);
  for (const char* name : {"TRB_SIZE", "TRB_NUMBER", "TRB_DONE_NUMBER", "TRB_RESULT", "TRB_OUT_SIZE"}) {
    v.declare(name, Type::int_, "0");
  }
  for (const char* name : {"TRB_CHUNK", "TRB_COMMAND", "TRB_DONE", "TRB_OUT", "TRB_STOP", "TRB_STOPPED"}) {
    v.declare(name, Type::bool_, "FALSE");
  }
  // As trb.dat has them before anybody has written them.
  v.declare("TRB_AXIS", Type::axis, "{A1 0,A2 -90,A3 90}");
  v.declare("TRB_POS", Type::pos, "{S 2,T 35}");
  v.declare("$OV_PRO", Type::int_, "100");
  v.declare("$STOPMESS", Type::bool_, "FALSE");
  v.declare("$ALARM_STOP", Type::bool_, "TRUE");  // as on the controller: FALSE while the emergency stop is pressed
  v.declare_live("$MODE_OP", [] { return std::string("#EX"); });
  v.declare_live("$PRO_STATE1", [this] { return std::string(running_ ? "#P_ACTIVE" : "#P_RESET"); });
  v.declare_live("$AXIS_ACT", [this] { return axis_text(); });
  v.declare_live("$POS_ACT", [this] { return pose_text(); });
}

std::string Program::axis_text() const {
  const arm::Joints joints = arm_.joints(now_);
  return structure_text(Type::axis, {joints.begin(), joints.end()});
}

std::string Program::pose_text() const {
  const arm::Pose pose = arm_.pose(now_);
  return structure_text(Type::pos, {pose.x, pose.y, pose.z, pose.a, pose.b, pose.c, 2, 35});
}

void Program::advance(double now) {
  now_ = now;
  const bool ended = arm_.advance(now);
  if (arm_.gripper_closed() != closed_) {
    closed_ = arm_.gripper_closed();
    emit(std::string("gripper ") + (closed_ ? "closed" : "open"));
  }
  if (!running_ || variables_.flag("$STOPMESS")) return;
  follow_stop(now);
  if (ended && skill_) finish(kWell, "");
  tell_next();
  if (variables_.flag("TRB_STOPPED")) return;
  if (variables_.flag("TRB_CHUNK")) take_chunk();
  if (!skill_ && variables_.flag("TRB_COMMAND") && !variables_.flag("TRB_DONE")) take_message(now);
}

/** The interrupt of trb.src: brakes, drops the message under way, and reports that. */
void Program::follow_stop(double now) {
  const bool stop = variables_.flag("TRB_STOP");
  if (stop == variables_.flag("TRB_STOPPED")) return;
  variables_.set("TRB_STOPPED", krl(stop));
  emit(stop ? "stopped" : "released");
  if (!stop) return;
  held_.clear();
  variables_.set("TRB_COMMAND", "FALSE");
  variables_.set("TRB_CHUNK", "FALSE");
  arm_.halt(now);
  if (skill_) finish(kStopped, "stopped");
}

void Program::take_chunk() {
  held_ += variables_.text("TRB_DATA");
  variables_.set("TRB_CHUNK", "FALSE");
}

void Program::take_message(double now) {
  const std::string type = variables_.text("TRB_TYPE");
  const std::string subtype = unescape_field(variables_.text("TRB_SUBTYPE"));
  const std::string data = unescape_field(held_ + variables_.text("TRB_DATA"));
  held_.clear();
  number_ = variables_.number("TRB_NUMBER");
  emit("message " + type + " " + escape_line(subtype) + " " + variables_.text("TRB_SOURCE") + " " +
       variables_.text("TRB_SIZE") + " " + escape_line(data));
  // Refused: the end is signalled before the message is taken, so that its sender gets it as the answer.
  if (type == "request") {
    answer(subtype);
  } else if (type == "command") {
    begin(subtype, now);
  } else {
    finish(kWell, "");
  }
  variables_.set("TRB_COMMAND", "FALSE");
}

void Program::begin(const std::string& subtype, double now) {
  const bool axes = subtype == "move" || subtype == "pick" || subtype == "grasp_and_put_down";
  const bool looks = subtype == "find_box";
  const bool known = axes || subtype == "go_home" || subtype == "move_to" || looks;
  if (!known) return finish(kWell, "");
  const arm::Joints target = first_six(variables_.numbers("TRB_AXIS"));
  const auto bad = axes ? arm::out_of_range(target) : std::nullopt;
  if (bad) return finish(kBadData, *bad);
  if (fails(subtype)) return finish(kInjected, "injected failure");
  if (looks) return finish(kWell, kSeen);
  const std::vector<double> p = variables_.numbers("TRB_POS");
  std::vector<arm::Step> steps{target};
  if (subtype == "go_home") steps = {arm::kHome};
  if (subtype == "move_to") steps = {arm::Pose{p[0], p[1], p[2], p[3], p[4], p[5]}};
  if (subtype == "pick") steps = arm::pick_steps(target);
  if (subtype == "grasp_and_put_down") steps = arm::grasp_and_put_down_steps(target);
  std::string where;
  const bool pose = subtype == "move_to";
  for (std::size_t i = 0; i < arm::kAxes; ++i) {
    where += " " + format_fixed(pose ? p[i] : axes ? target[i] : arm::kHome[i], 2);
  }
  emit("start " + subtype + where);
  skill_ = subtype;
  arm_.start(std::move(steps), now);
}

void Program::answer(const std::string& subtype) {
  if (subtype == "gripper") return finish(kWell, closed_ ? "closed" : "open");
  finish(kUnknown, "unknown request " + subtype.substr(0, 60));
}

void Program::finish(int result, const std::string& text) {
  emit((result == kWell ? "done " : "failed ") + std::to_string(number_) + " " + skill_.value_or("-") +
       (text.empty() ? "" : " " + escape_line(text)));
  variables_.set("TRB_DONE_NUMBER", std::to_string(number_));
  variables_.set("TRB_RESULT", std::to_string(result));
  variables_.set("TRB_TEXT", escape_field(text));
  variables_.set("TRB_DONE", "TRUE");
  skill_.reset();
}

bool Program::fails(const std::string& skill) {
  bool fails = false;
  for (std::size_t i = 0; i < failures_.size(); ++i) {
    if (failures_[i].skill != skill) continue;
    ++calls_[i];
    fails = fails || !failures_[i].call || *failures_[i].call == calls_[i];
  }
  return fails;
}

void Program::say(std::string type, std::string subtype, std::string target, std::string data) {
  if (sayings_.size() == kMostSayings) return emit("lost " + subtype);
  const std::size_t size = data.size();
  sayings_.push_back({std::move(type), std::move(subtype), std::move(target), escape_field(data), size});
}

/** Sends one chunk, once the node has read the last one. */
void Program::tell_next() {
  if (sayings_.empty() || variables_.flag("TRB_OUT")) return;
  Saying& saying = sayings_.front();
  const std::size_t part = whole_escapes(saying.data, variables_.room("TRB_OUT_DATA"));
  variables_.set("TRB_OUT_TYPE", saying.type);
  variables_.set("TRB_OUT_SUBTYPE", saying.subtype);
  variables_.set("TRB_OUT_TARGET", saying.target);
  variables_.set("TRB_OUT_SIZE", std::to_string(saying.size));
  variables_.set("TRB_OUT_DATA", saying.data.substr(0, part));
  variables_.set("TRB_OUT", "TRUE");
  saying.data.erase(0, part);
  if (saying.data.empty()) sayings_.pop_front();
}

void Program::raise_fault(const std::string& capability, const std::string& severity, const std::string& text,
                          double now) {
  advance(now);
  variables_.set("TRB_ERROR", escape_field(capability + " " + severity + " " + text));
  emit("fault " + capability + " " + severity);
  if (severity == "WARNING") return;
  arm_.pause(now);
  if (severity == "FATAL") variables_.set("$ALARM_STOP", "FALSE");
  variables_.set("$STOPMESS", "TRUE");
}

void Program::clear(double now) {
  variables_.set("TRB_ERROR", "");
  variables_.set("$ALARM_STOP", "TRUE");
  variables_.set("$STOPMESS", "FALSE");
  emit("cleared");
  arm_.resume(now);
  advance(now);
}

void Program::select(bool running, double now) {
  running_ = running;
  emit(running ? "program selected" : "program cancelled");
  if (running) return advance(now);
  arm_.halt(now);
  skill_.reset();
}

std::optional<double> Program::next_deadline() const {
  return arm_.next_deadline();
}

std::vector<std::string> Program::take_events() {
  return std::exchange(events_, {});
}

}  // namespace trb::virtual_robots::kuka
