#include "services/cli/commands/command.hpp"

namespace trb::cli {

std::vector<Command> all_commands() {
  std::vector<Command> out;
#define TRB_ADD_GROUP(Name) \
  for (Command & command : Name##_commands()) out.push_back(std::move(command));
  TRB_COMMAND_GROUPS(TRB_ADD_GROUP)
#undef TRB_ADD_GROUP
  return out;
}

std::vector<CommandText> texts_of(const std::vector<Command>& commands) {
  std::vector<CommandText> out;
  for (const Command& command : commands) out.push_back({command.name, command.usage});
  return out;
}

}  // namespace trb::cli
