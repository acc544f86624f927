// trb-cloud-gateway NODE_DIR: the API and the live stream for people. See README.md.
#include <cstdio>
#include <string_view>

#include "common/service/service.hpp"
#include "common/service/service_main.hpp"
#include "proto/value.hpp"
#include "services/cloud-gateway/io/http/tls_check.hpp"
#include "services/cloud-gateway/io/start.hpp"

namespace {

/// For `trb check`, which does not have OpenSSL: what is wrong with the page's certificate, as JSON.
int check_certificate(const char* node_dir) {
  trb::Value::List list;
  for (const trb::ConfigFault& fault : trb::gateway::check_tls_files(node_dir, trb::now().utc)) {
    list.push_back(trb::Value{trb::Value::Object{
        {"file", trb::Value{fault.file}}, {"what", trb::Value{fault.what}}, {"cure", trb::Value{fault.hint}}}});
  }
  const trb::Value json{trb::Value::Object{{"faults", trb::Value{std::move(list)}}}};
  return std::puts(trb::dump_json(json).c_str()) < 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--check-certificate") return check_certificate(argv[2]);
  return trb::service_main(argc, argv,
                           {"cloud-gateway", "Serves the fleet to people: an API over HTTPS and a live stream.",
                            "nodes/cloud", trb::gateway::start});
}
