// `trb model --protocol talkrobots`: what our own protocol sends between computers, term by term.
#pragma once

#include <string>
#include <vector>

#include "services/cli/core/arguments.hpp"

namespace trb::cli {

int run_own_model(const Arguments& arguments);

/// Options that the paper's equations have not, with their texts.
std::vector<std::string> own_model_options();

/// The first option that was given and belongs to the other protocol, as an error.
Status check_protocol_options(const Arguments& arguments, bool own);

}  // namespace trb::cli
