#include "common/operator/try_cures.hpp"

namespace trb::op {
namespace {

bool by_fields(const NodeProfile& profile) {
  return profile.mode == "interpreter" && (profile.transport.empty() || profile.transport == "lines");
}

std::string words_of(const NodeProfile& profile) {
  return "commands.json: " + profile.framework;
}

bool says(const std::string& text, std::string_view word) {
  return text.find(word) != std::string::npos;
}

}  // namespace

std::string cure_of_connection(const NodeProfile& profile) {
  if (by_fields(profile)) {
    return "start the robot's own program: it dials TCP_PORT of network.json on this node's \"robot.interface\", from "
           "the "
           "address \"robot.host\" of node.json";
  }
  if (profile.transport == "ros")
    return words_of(profile) +
           ": its ROS master's address; is roscore up, and is \"ros-bridge\" in \"services\" of node.json?";
  return "node.json: robot.host is the controller's address, " + words_of(profile) +
         ".port its port; ping it from this computer, and look what the robot itself needs: trb node new prints it";
}

std::string cure_of_request(const NodeProfile& profile, const std::string& word, std::string_view code) {
  if (by_fields(profile))
    return "let the robot's own program answer the request '" + word + "': trb robot conform shows how";
  if (code == errc_name(Errc::unknown_subtype) || code == errc_name(Errc::no_field_channel))
    return words_of(profile) + ".requests: name '" + word + "' there with the value that the controller tells";
  if (code == errc_name(Errc::timeout) || code == errc_name(Errc::robot_offline))
    return words_of(profile) +
           ": the monitor's port, or the values that the node polls; is the controller's interface on?";
  return words_of(profile) + ".requests." + word +
         ": which value the controller tells there, and its unit in \"frame\" of the description";
}

std::string cure_of_skill(const NodeProfile& profile, const std::string& skill, const std::string& reason) {
  const std::string at = "the description (\"description\" in node.json): skills." + skill;
  if (says(reason, errc_name(Errc::unknown_subtype)) || says(reason, errc_name(Errc::no_field_channel)))
    return at + ".command names a word that " + words_of(profile) + ".commands lacks: add it there";
  if (says(reason, "timeout") || says(reason, "timed out") || says(reason, "not within"))
    return at + ".end says by what its end is seen, .timeout_s how long it may take";
  if (says(reason, "place")) return "places.json, or \"places\" of the description: the place that was named";
  if (by_fields(profile)) return "the robot's own program: what it does at the command of " + at;
  return "first the robot itself (its mode, its brakes, its program); then " + at + ".command.data and " +
         words_of(profile) + ".commands";
}

std::string cure_of_control(const NodeProfile& profile) {
  constexpr std::string_view kRun = "run ";
  if (!profile.control.starts_with(kRun)) return "let it end: control ends 10 s after its last command";
  return "wait for its end, or end it: trb scenario abort " + profile.control.substr(kRun.size());
}

std::string cure_of_order(const NodeProfile& profile, const std::string& order) {
  if (by_fields(profile)) return "the robot's own program has to confirm '" + order + "': trb robot conform shows how";
  return words_of(profile) + ".commands." + order +
         ": the controller's own word for it; trb logs NODE_DIR shows what it answered";
}

}  // namespace trb::op
