// One entry of trb: its words, what it takes, what it does.
#pragma once

#include <string>
#include <vector>

#include "services/cli/core/arguments.hpp"

namespace trb::cli {

struct Command {
  std::vector<std::string> name;  ///< {"route", "list"}
  Usage usage;
  int (*run)(const Arguments&) = nullptr;
};

// The commands, a file each group.
std::vector<Command> node_commands();
std::vector<Command> message_commands();
std::vector<Command> list_commands();
std::vector<Command> fault_commands();
std::vector<Command> history_commands();
std::vector<Command> robot_use_commands();
std::vector<Command> run_commands();
std::vector<Command> scenario_commands();
std::vector<Command> fleet_commands();
std::vector<Command> doctor_commands();
std::vector<Command> fleet_news_commands();
std::vector<Command> proof_commands();
std::vector<Command> rank_commands();
std::vector<Command> robot_check_commands();
std::vector<Command> robot_conform_commands();
std::vector<Command> sensor_commands();
std::vector<Command> alert_commands();

/// `trb help TOPIC`; the empty topic lists them. Empty if there is no such topic.
std::string topic_text(const std::string& topic);

}  // namespace trb::cli
