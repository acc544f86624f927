// A router's table, which comes in pages, put together again.
#pragma once

#include <optional>
#include <string>

#include "proto/bodies/bus.hpp"
#include "proto/bodies/link.hpp"

namespace trb {

class RoutePages {
 public:
  /// What a page has brought: the whole table, or what to ask for next. Neither: a page of an older asking.
  struct Taken {
    std::optional<RouteTable> whole;
    std::optional<RouteListRequest> next;
  };

  /// The first page begins anew, so that whoever got no answer just asks again with RouteListRequest{}.
  Taken take(RouteTable page);

 private:
  RouteTable table_;
  std::string after_;  ///< with what the next page was asked for; empty: none was
};

}  // namespace trb
