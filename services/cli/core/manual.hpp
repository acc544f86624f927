#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/cli/core/command_text.hpp"

namespace trb::cli {

/// The manual page trb(1) in the macros of man(7): every command with its options and examples, and the topics of `trb
/// help`.
std::string manual_page(const std::vector<CommandText>& commands,
                        const std::vector<std::pair<std::string, std::string>>& topics, const std::string& version);

}  // namespace trb::cli
