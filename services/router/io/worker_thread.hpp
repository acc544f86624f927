// A thread beside the router's loop.
#pragma once

#include <csignal>
#include <thread>
#include <utility>

namespace trb::router {

/// Runs `work` on a thread that receives no signals: the router's loop takes them all.
template <class Work>
std::thread start_without_signals(Work&& work) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread(std::forward<Work>(work));
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

}  // namespace trb::router
