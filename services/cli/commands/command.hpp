// One entry of trb: its words, what it takes, what it does.
#pragma once

#include <string>
#include <vector>

#include "services/cli/core/arguments.hpp"
#include "services/cli/core/command_text.hpp"

namespace trb::cli {

struct Command {
  std::vector<std::string> name;  ///< {"route", "list"}
  Usage usage;
  int (*run)(const Arguments&) = nullptr;
};

/// Of a certificate: a century.
inline constexpr double kMostDays = 36500;

// Options of several groups.
inline constexpr const char* kJson = "--json|for programs";
inline constexpr const char* kAskedNode = "--node DIR|the node to ask (else TRB_NODE, else this folder)";
inline constexpr const char* kSendingNode = "--node DIR|the node to send from (else TRB_NODE, else this folder)";
inline constexpr const char* kPassphrase =
    "--passphrase-file FILE|its first line (else TRB_PASSPHRASE, else the terminal)";

// A line a group, in the order of `trb help`; a group is a file here, which defines GROUP_commands().
#define TRB_COMMAND_GROUPS(GROUP) \
  GROUP(node)                     \
  GROUP(node_new)                 \
  GROUP(node_join)                \
  GROUP(demo)                     \
  GROUP(node_backup)              \
  GROUP(message)                  \
  GROUP(list)                     \
  GROUP(fault)                    \
  GROUP(history)                  \
  GROUP(robot_use)                \
  GROUP(run)                      \
  GROUP(scenario)                 \
  GROUP(fleet)                    \
  GROUP(invite)                   \
  GROUP(trust_update)             \
  GROUP(doctor)                   \
  GROUP(proof)                    \
  GROUP(audit)                    \
  GROUP(rank)                     \
  GROUP(model)                    \
  GROUP(simulate)                 \
  GROUP(robot_check)              \
  GROUP(robot_certificate)        \
  GROUP(robot_try)                \
  GROUP(robot_conform)            \
  GROUP(sensor)                   \
  GROUP(alert)                    \
  GROUP(cloud)                    \
  GROUP(shell)

#define TRB_DECLARE_GROUP(Name) std::vector<Command> Name##_commands();
TRB_COMMAND_GROUPS(TRB_DECLARE_GROUP)
#undef TRB_DECLARE_GROUP

/// Every command, in the order of `trb help`.
std::vector<Command> all_commands();
std::vector<CommandText> texts_of(const std::vector<Command>& commands);

/// `trb help TOPIC`; the empty topic lists them. Empty if there is no such topic.
std::string topic_text(const std::string& topic);
std::vector<std::string> topic_names();

}  // namespace trb::cli
