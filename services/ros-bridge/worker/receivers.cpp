#include "services/ros-bridge/worker/receivers.hpp"

#include <ros/ros.h>

namespace trb::ros {
namespace {

constexpr std::chrono::milliseconds kGather{500};

/// Of itself ROS tells no name.
bool is_other(const std::string& node) {
  return !node.empty() && node != ::ros::this_node::getName();
}

std::set<std::string> others_of(XmlRpc::XmlRpcValue& nodes) {
  std::set<std::string> names;
  for (int i = 0; i < nodes.size(); ++i) {
    if (const std::string name = nodes[i]; is_other(name)) names.insert(name);
  }
  return names;
}

/// The nodes that have told the master that they subscribe.
std::set<std::string> subscribers_at_master(const std::string& topic) {
  XmlRpc::XmlRpcValue request;
  XmlRpc::XmlRpcValue response;
  XmlRpc::XmlRpcValue state;  // publishers, subscribers, services: a list of topics with their nodes each
  request[0] = ::ros::this_node::getName();
  if (!::ros::master::execute("getSystemState", request, response, state, false)) return {};
  const std::string full = ::ros::names::resolve(topic);
  XmlRpc::XmlRpcValue& topics = state[1];
  for (int i = 0; i < topics.size(); ++i) {
    if (std::string(topics[i][0]) == full) return others_of(topics[i][1]);
  }
  return {};
}

}  // namespace

void Receivers::add(const std::string& node) {
  if (is_other(node)) connected_.insert(node);
}

void Receivers::remove(const std::string& node) {
  if (const auto one = connected_.find(node); one != connected_.end()) connected_.erase(one);
  complete_by_.reset();  // it may be about to come back
}

bool Receivers::are_complete(const std::string& topic) {
  if (connected_.empty()) return false;
  if (!complete_by_) {
    awaited_ = subscribers_at_master(topic);
    complete_by_ = Clock::now() + kGather;
  }
  std::erase_if(awaited_, [this](const std::string& node) { return connected_.contains(node); });
  if (Clock::now() >= *complete_by_) awaited_.clear();
  return awaited_.empty();
}

}  // namespace trb::ros
