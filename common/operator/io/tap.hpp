#pragma once

#include <functional>

#include "common/operator/tap_record.hpp"
#include "common/service/bus_address.hpp"
#include "common/transport/loop.hpp"

namespace trb::op {

/// Receives a copy of what passes a node's router. A tap that reads too slowly loses messages; the node never waits for
/// it.
class Tap {
 public:
  /// False: it wants no more of this batch.
  using OnRecord = std::function<bool(const TapRecord&)>;
  Tap(Context& context, Loop& loop, const BusAddress& address, TapFilter filter, OnRecord on_record);
  ~Tap();
  Tap(const Tap&) = delete;
  Tap& operator=(const Tap&) = delete;

 private:
  void drain();

  Loop& loop_;
  Socket socket_;
  const TapFilter filter_;
  const OnRecord on_record_;
};

}  // namespace trb::op
