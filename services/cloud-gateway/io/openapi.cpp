#include "services/cloud-gateway/io/openapi.hpp"

#include "common/base/embedded_file.hpp"

namespace trb {
std::span<const EmbeddedFile> gateway_api_files();
}

namespace trb::gateway {

std::string_view openapi_json() {
  return gateway_api_files()[0].bytes;
}

}  // namespace trb::gateway
