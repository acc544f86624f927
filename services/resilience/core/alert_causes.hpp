// Alert::cause: why there is an alert. deploy/handbook/on-call/alerts.md has a section for each of these, by a test.
#pragma once

#include <string_view>

namespace trb::resilience {

constexpr std::string_view kRobotFault = "robot_fault";      ///< a CRITICAL or FATAL fault stands, or a lesser one came
constexpr std::string_view kRobotRetired = "robot_retired";  ///< a person took it out of service
constexpr std::string_view kRobotLost = "robot_connection";  ///< its node is there, the robot is not
constexpr std::string_view kNodeLost = "peer_expired";       ///< its node is not reached
constexpr std::string_view kTaskFailed = "task_failed";      ///< the robot says so
constexpr std::string_view kTaskInterrupted = "task_interrupted";  ///< nobody knows whether it was done
constexpr std::string_view kWantsRobot = "robot_wanted";           ///< nothing has failed, a robot has to be chosen
constexpr std::string_view kOverdue = "task_overdue";              ///< it should have ended, or begun
constexpr std::string_view kTwice = "double_execution";            ///< two robots have done it: the run is held
constexpr std::string_view kRunEnds = "run_ends";                  ///< its time to live is nearly over
constexpr std::string_view kAsked = "asked";                       ///< nothing has failed: a person wants a change

}  // namespace trb::resilience
