// Checks seals: on a thread, or at once where frames wait for one.
#pragma once

#include "services/router/io/seal_checker.hpp"
#include "services/router/io/shell_context.hpp"

namespace trb::router {

/// Reports to the core whether each seal is good: later, or before check() returns if frames of its link are held or
/// the thread has enough to do.
class SealVerifier {
 public:
  explicit SealVerifier(ShellContext& shell) : shell_(shell) {}

  /// The loop takes the thread's results.
  void watch();
  void check(CheckSeal&& seal);

 private:
  void take_checked();
  void on_checked(const CheckSeal& seal, bool good);

  ShellContext& shell_;
  SealChecker checker_;
};

}  // namespace trb::router
