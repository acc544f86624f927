// The API's description, api/openapi.json: it is part of the program.
#pragma once

#include <string_view>

namespace trb::gateway {

std::string_view openapi_json();

}  // namespace trb::gateway
