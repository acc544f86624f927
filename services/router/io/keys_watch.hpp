// Notifies when a file is written into a folder, gets other rights, or goes: a person brings trust updates by hand.
#pragma once

#include <functional>
#include <string>

#include "common/base/descriptor.hpp"
#include "common/transport/loop.hpp"

namespace trb::router {

class KeysWatch {
 public:
  /// Without inotify (or the folder) there are no notifications; a start reads the folder anyway.
  KeysWatch(Loop& loop, const std::string& folder, std::function<void()> on_change);
  ~KeysWatch();
  KeysWatch(const KeysWatch&) = delete;
  KeysWatch& operator=(const KeysWatch&) = delete;

 private:
  Loop& loop_;
  Descriptor fd_;
};

}  // namespace trb::router
