#include "common/transport/signals.hpp"

#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

namespace trb {
namespace {

sigset_t signal_set(bool with_pipe) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&set, signal);
  if (with_pipe) sigaddset(&set, SIGPIPE);
  return set;
}

}  // namespace

void block_signals() {
  const sigset_t set = signal_set(true);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

Signals::Signals(Loop& loop, std::function<void(int)> on_signal) : loop_(loop) {
  const sigset_t set = signal_set(false);
  fd_ = Descriptor(::signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC));
  if (!fd_) throw std::runtime_error("signalfd failed");
  loop_.add_fd(fd_.get(), POLLIN, [this, handler = std::move(on_signal)](short) {
    signalfd_siginfo info{};
    while (::read(fd_.get(), &info, sizeof info) == static_cast<ssize_t>(sizeof info))
      handler(static_cast<int>(info.ssi_signo));
  });
}

Signals::~Signals() {
  loop_.remove_fd(fd_.get());
}

}  // namespace trb
