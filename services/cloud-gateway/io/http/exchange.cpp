#include "services/cloud-gateway/io/http/exchange.hpp"

namespace trb::gateway {

RequestHead HttpRequest::head() const {
  return {method, target, host, session, bearer, origin, csrf};
}

}  // namespace trb::gateway
