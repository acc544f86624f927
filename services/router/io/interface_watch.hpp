// Notifies when an address or an interface of this machine comes, goes or changes (netlink).
#pragma once

#include <functional>
#include <memory>

#include "common/base/descriptor.hpp"
#include "common/base/result.hpp"
#include "common/transport/loop.hpp"

namespace trb::router {

class InterfaceWatch {
 public:
  /// `on_change` is called once for all waiting changes; it reads the state itself. Errors: io_error.
  static Result<std::unique_ptr<InterfaceWatch>> open(Loop& loop, std::function<void()> on_change);
  ~InterfaceWatch();
  InterfaceWatch(const InterfaceWatch&) = delete;
  InterfaceWatch& operator=(const InterfaceWatch&) = delete;

 private:
  InterfaceWatch(Loop& loop, Descriptor fd, std::function<void()> on_change);
  void drain();
  Loop& loop_;
  Descriptor fd_;
  std::function<void()> on_change_;
};

}  // namespace trb::router
