// Which sockets may have a message that their descriptor does not signal.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace trb {

/// Of one socket: true while a message may wait that its descriptor does not signal. When it becomes true the socket
/// enters the list of its loop, so that a turn visits only these: a walk over the sockets of a thousand links for each
/// message would be what a router mostly does.
class Unseen {
 public:
  /// The sockets that are to be looked at, each once.
  using List = std::vector<void*>;

  /// From now on `socket` enters this list; at once if it is unseen. It leaves any list it was in.
  void join(std::shared_ptr<List> list, void* socket) {
    leave(list_);
    list_ = std::move(list);
    socket_ = socket;
    if (is_unseen_) enter();
  }
  /// Leaves this list for good, unless it has joined another since.
  void leave(const std::shared_ptr<List>& list) {
    if (list != list_) return;
    if (is_listed_) std::erase(*list_, socket_);
    is_listed_ = false;
    list_.reset();
  }
  /// The loop has taken it off the list itself.
  void unlisted() { is_listed_ = false; }

  void set(bool unseen) {
    is_unseen_ = unseen;
    if (unseen && !is_listed_ && list_ != nullptr) enter();
  }
  explicit operator bool() const { return is_unseen_; }

 private:
  void enter() {
    list_->push_back(socket_);
    is_listed_ = true;
  }

  bool is_unseen_ = true;
  bool is_listed_ = false;
  std::shared_ptr<List> list_;
  void* socket_ = nullptr;
};

}  // namespace trb
