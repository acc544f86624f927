// The thread that checks the signatures of seals: one takes some 40 us, half the time of a message's whole way.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "common/base/descriptor.hpp"
#include "services/router/core/effects.hpp"

namespace trb::router {

class SealChecker {
 public:
  struct Checked {
    CheckSeal seal;
    bool good = false;
  };

  SealChecker();
  ~SealChecker();
  SealChecker(const SealChecker&) = delete;
  SealChecker& operator=(const SealChecker&) = delete;

  /// False: as many wait already as may; the seal is unchanged, and the caller checks it.
  bool put(CheckSeal&& seal);
  /// Readable when a check is done.
  [[nodiscard]] int fd() const { return fd_.get(); }
  std::vector<Checked> take();

 private:
  void run();

  Descriptor fd_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<CheckSeal> queue_;  ///< this and the next two are under the mutex
  std::vector<Checked> checked_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace trb::router
