// Puts a router's table together again from its pages.
#pragma once

#include <optional>
#include <string>

#include "proto/bodies/bus.hpp"
#include "proto/bodies/link.hpp"

namespace trb {

class RoutePages {
 public:
  /// What a page completes: the whole table, or the next request. Neither: the page answers an older request.
  struct Taken {
    std::optional<RouteTable> whole;
    std::optional<RouteListRequest> next;
  };

  /// The first page starts anew, so after a lost answer one simply asks again with RouteListRequest{}.
  Taken take(RouteTable page);

 private:
  RouteTable table_;
  std::string after_;  ///< the `after` of the request for the next page; empty: none was sent
};

}  // namespace trb
