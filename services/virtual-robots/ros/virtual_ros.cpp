#include "services/virtual-robots/ros/virtual_ros.hpp"

#include <actionlib_msgs/GoalID.h>
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/Twist.h>
#include <nav_msgs/Odometry.h>
#include <poll.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/BatteryState.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Empty.h>
#include <std_msgs/String.h>
#include <std_msgs/UInt8.h>

#include <array>
#include <cmath>
#include <limits>

#include "services/virtual-robots/ros/goal.hpp"
#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/process.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ros {
namespace {

namespace roscpp = ::ros;

constexpr double kTurn = 0.02;
constexpr double kStatePeriod = 0.1;
constexpr double kBatteryPeriod = 1.0;
constexpr double kDriveHolds = 0.5;  // as the bases' own time-out for commands
constexpr std::uint32_t kQueue = 10;

constexpr double kEmptyVolts = 21.0;  // lead-acid of 24 V, from empty to full
constexpr double kFullVolts = 25.4;

SentPose sent(const geometry_msgs::Pose& pose) {
  return {pose.position.x,    pose.position.y,    pose.position.z,   pose.orientation.x,
          pose.orientation.y, pose.orientation.z, pose.orientation.w};
}

bool is_finite(const geometry_msgs::Twist& twist) {
  for (const auto& one : {twist.linear, twist.angular}) {
    if (!std::isfinite(one.x) || !std::isfinite(one.y) || !std::isfinite(one.z)) return false;
  }
  return true;
}

/** Voltage must be told; of the rest this robot measures the charge, and NaN is "not measured". */
sensor_msgs::BatteryState battery_state(double percent) {
  constexpr float kNotMeasured = std::numeric_limits<float>::quiet_NaN();
  sensor_msgs::BatteryState battery;
  battery.voltage = static_cast<float>(kEmptyVolts + (kFullVolts - kEmptyVolts) * percent / 100);
  battery.percentage = static_cast<float>(percent / 100);
  battery.temperature = battery.current = battery.charge = kNotMeasured;
  battery.capacity = battery.design_capacity = kNotMeasured;
  battery.power_supply_status = sensor_msgs::BatteryState::POWER_SUPPLY_STATUS_DISCHARGING;
  battery.present = 1;
  return battery;
}

std::string text_of(const Pose& pose) {
  return format_fixed(pose.x, 3) + " " + format_fixed(pose.y, 3) + " " + format_fixed(pose.yaw, 3);
}

class VirtualRos {
 public:
  explicit VirtualRos(const Settings& settings)
      : settings_(settings), body_(settings.start, settings.battery_percent), control_(settings.control) {
    listen();
    advertise();
  }

  void run(const Fd& end) {
    control_.announce();
    print_line("ready");
    while (!quit_) {
      roscpp::getGlobalCallbackQueue()->callAvailable(roscpp::WallDuration(kTurn));
      std::array<pollfd, 3> polled{pollfd{end.get(), POLLIN, 0}, pollfd{console_.fd(), POLLIN, 0},
                                   pollfd{control_.fd(), POLLIN, 0}};
      ::poll(polled.data(), polled.size(), 0);
      if (polled[0].revents != 0) return;
      if (polled[1].revents != 0) {
        for (const std::string& line : console_.read()) take_line(line);
      }
      if (polled[2].revents != 0) {
        for (const std::string& line : control_.read()) take_line(line);
      }
      step();
      flush_lines();
    }
  }

 private:
  template <class Message, class Handler>
  void on(const std::string& topic, Handler handler) {
    subscribers_.push_back(node_.subscribe<Message>(
        topic, kQueue,
        boost::function<void(const boost::shared_ptr<const Message>&)>(
            [handler](const boost::shared_ptr<const Message>& message) { handler(*message); })));
  }

  void listen() {
    on<geometry_msgs::Twist>("cmd_vel", [this](const auto& twist) { drive(twist); });
    on<geometry_msgs::PoseStamped>("move_base_simple/goal", [this](const auto& goal) { go_to(goal); });
    on<actionlib_msgs::GoalID>("move_base/cancel", [this](const auto&) { cancel(); });
    if (!settings_.arm) return;
    on<geometry_msgs::PoseArray>("task/fetch", [this](const auto& way) { fetch(way); });
    on<std_msgs::Empty>("task/load_out", [this](const auto&) {
      print_line("load_out");
      body_.load_out(now());
    });
    on<std_msgs::Empty>("task/cancel", [this](const auto&) { cancel(); });
  }

  void drive(const geometry_msgs::Twist& twist) {
    if (!is_finite(twist)) return print_line("refused cmd_vel a number is not finite");
    print_line("twist " + format_fixed(twist.linear.x, 3) + " " + format_fixed(twist.linear.y, 3) + " " +
               format_fixed(twist.angular.z, 3));
    body_.drive({twist.linear.x, twist.linear.y, twist.angular.z}, now(), now() + kDriveHolds * settings_.speed);
  }

  /** As with move_base a goal that is refused has already taken the place of the one before. */
  void go_to(const geometry_msgs::PoseStamped& sent_goal) {
    body_.advance(now());
    const Goal goal = goal_in_map(sent_goal.header.frame_id, sent(sent_goal.pose), body_.pose());
    if (!goal.refused.empty()) {
      body_.cancel(now());
      return print_line("refused goal " + escape_line(goal.refused));
    }
    print_line("goal " + text_of(goal.pose));
    body_.go_to(goal.pose, now());
  }

  void fetch(const geometry_msgs::PoseArray& way) {
    if (way.poses.size() != 2) return refuse_fetch("two poses are needed, not " + std::to_string(way.poses.size()));
    body_.advance(now());
    const Goal from = goal_in_map(way.header.frame_id, sent(way.poses[0]), body_.pose());
    const Goal to = goal_in_map(way.header.frame_id, sent(way.poses[1]), body_.pose());
    if (!from.refused.empty()) return refuse_fetch(from.refused);
    if (!to.refused.empty()) return refuse_fetch(to.refused);
    print_line("fetch " + text_of(from.pose) + " " + text_of(to.pose));
    body_.fetch(from.pose, to.pose, now());
  }

  void refuse_fetch(const std::string& reason) {
    body_.refuse_task(now());
    print_line("refused fetch " + escape_line(reason));
  }

  void advertise() {
    odometry_ = node_.advertise<nav_msgs::Odometry>("odom", kQueue);
    battery_ = node_.advertise<sensor_msgs::BatteryState>("battery", 1, true);
    error_ = node_.advertise<std_msgs::String>("error", 1, true);
    if (!settings_.arm) return;
    joints_ = node_.advertise<sensor_msgs::JointState>("joint_states", kQueue);
    task_ = node_.advertise<std_msgs::UInt8>("task/state", kQueue);
    arm_error_ = node_.advertise<std_msgs::String>("task/error", 1, true);
  }

  void cancel() {
    print_line("cancelled");
    body_.cancel(now());
  }

  void take_line(const std::string& line) {
    tell_task();  // a task that a fault ends as soon as it begins is reported as begun and as failed
    std::string_view words = line;
    const std::string_view order = take_word(words);
    if (order == "quit") {
      quit_ = true;
    } else if (order == "where") {
      body_.advance(now());
      print_line(where_line({body_.pose().x, body_.pose().y, body_.pose().yaw}));
    } else if (order == "clear") {
      body_.clear();
      warning_.clear();
      told_base_fault_.clear();
      publish_errors();
    } else if (const auto fault = parse_fault_order(words); order == "fault" && fault) {
      take_fault(*fault);
    } else if (order == "fail_next_goal") {
      body_.fail_next_goal(words.empty() ? "mobile failed" : std::string(words));
    } else if (const auto percent = parse_number(words); order == "battery" && percent) {
      body_.set_battery(std::clamp(*percent, 0.0, 100.0));
    } else {
      print_line("unknown_line");
    }
  }

  /** It stands, unless the fault is a warning; an error topic gives the reason: the arm's for the arm's part. */
  void take_fault(const FaultOrder& order) {
    const std::string text = order.text.empty() ? order.capability + " failed" : order.text;
    if (order.severity == "WARNING") {
      warning_ = text;
    } else if (settings_.arm && order.capability != "mobile") {
      body_.arm_fault(text, now());
    } else {
      body_.fault(text, now());
    }
    tell_fault(text);
  }

  void tell_fault(const std::string& text) {
    told_base_fault_ = body_.fault_text();
    publish_errors();
    print_line("fault " + escape_line(text));
  }

  void publish_errors() {
    std_msgs::String text;
    text.data = body_.fault_text().empty() ? warning_ : body_.fault_text();
    error_.publish(text);
    if (!settings_.arm) return;
    text.data = body_.arm_fault_text();
    arm_error_.publish(text);
  }

  void step() {
    body_.advance(now());
    if (body_.fault_text() != told_base_fault_) tell_fault(body_.fault_text());
    tell_task();
    const double at = wall_seconds();
    if (at >= next_state_) publish_state(at);
    if (at >= next_battery_) publish_battery(at);
  }

  void tell_task() {
    if (body_.task() == told_task_) return;
    told_task_ = body_.task();
    print_line("task " + std::to_string(static_cast<int>(told_task_)));
    publish_task();
  }

  void publish_state(double at) {
    next_state_ = at + kStatePeriod;
    nav_msgs::Odometry odometry;
    odometry.header.stamp = roscpp::Time::now();
    odometry.header.frame_id = "map";
    odometry.child_frame_id = "base_link";
    odometry.pose.pose.position.x = body_.pose().x;
    odometry.pose.pose.position.y = body_.pose().y;
    odometry.pose.pose.orientation.z = std::sin(body_.pose().yaw / 2);
    odometry.pose.pose.orientation.w = std::cos(body_.pose().yaw / 2);
    odometry.twist.twist.linear.x = body_.velocity().x;
    odometry.twist.twist.linear.y = body_.velocity().y;
    odometry.twist.twist.angular.z = body_.velocity().turn;
    odometry_.publish(odometry);
    if (!settings_.arm) return;
    publish_task();
    sensor_msgs::JointState joints;
    joints.header.stamp = odometry.header.stamp;
    joints.name = {"right_j0", "right_j1", "right_j2", "right_j3", "right_j4", "right_j5", "right_j6"};
    const auto angles = body_.joints();
    joints.position.assign(angles.begin(), angles.end());
    joints_.publish(joints);
  }

  void publish_task() {
    if (!settings_.arm) return;
    std_msgs::UInt8 task;
    task.data = static_cast<std::uint8_t>(body_.task());
    task_.publish(task);
  }

  void publish_battery(double at) {
    next_battery_ = at + kBatteryPeriod;
    publish_errors();
    sensor_msgs::BatteryState battery = battery_state(body_.battery_percent());
    battery.header.stamp = roscpp::Time::now();
    battery_.publish(battery);
  }

  double now() const { return (wall_seconds() - begin_) * settings_.speed; }

  Settings settings_;
  double begin_ = wall_seconds();
  Body body_;
  roscpp::NodeHandle node_;
  std::vector<roscpp::Subscriber> subscribers_;
  roscpp::Publisher odometry_, battery_, error_, arm_error_, joints_, task_;
  StdinLines console_;
  ControlPort control_;
  std::string warning_;
  std::string told_base_fault_;
  Task told_task_ = Task::idle;
  double next_state_ = 0;
  double next_battery_ = 0;
  bool quit_ = false;
};

/** False if the end comes first. Without a master NodeHandle's constructor would block without end. */
bool wait_for_master(const Fd& end) {
  bool told = false;
  while (!roscpp::master::check()) {
    if (!told) print_line("waits_for_master " + roscpp::master::getURI());
    told = true;
    pollfd polled{end.get(), POLLIN, 0};
    constexpr int kAgain_ms = 200;
    if (::poll(&polled, 1, kAgain_ms) > 0) return false;
  }
  return true;
}

}  // namespace

void run_virtual_ros(const Settings& settings, const Fd& end) {
  roscpp::M_string names{{"__master", settings.master}, {"__ip", settings.ip}, {"__ns", "/" + settings.name_space}};
  roscpp::init(names, "robot", roscpp::init_options::NoSigintHandler | roscpp::init_options::NoRosout);
  if (!wait_for_master(end)) return;
  VirtualRos(settings).run(end);
}

}  // namespace trb::virtual_robots::ros
