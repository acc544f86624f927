#include "common/supervisor/reload_signal.hpp"

#include <cerrno>
#include <csignal>

#include "common/base/files.hpp"

namespace trb::supervisor {
namespace {

constexpr std::size_t kKernelsName = 15;  ///< what the kernel keeps of a program's name

}  // namespace

Status ask_to_reload(pid_t pid, const std::string& service) {
  const std::string which = service + " (pid " + std::to_string(pid) + ")";
  const auto program = pid > 0 ? read_file("/proc/" + std::to_string(pid) + "/comm") : fail(Errc::missing, "no pid");
  if (!program) return fail(Errc::missing, which + " has ended", "wait until it is up again");
  if (*program != ("trb-" + service).substr(0, kKernelsName) + "\n") {
    return fail(Errc::conflict, which + " is another program on this machine", "run trb reload where it runs");
  }
  if (::kill(pid, SIGHUP) == 0) return Done{};
  if (errno == ESRCH) return fail(Errc::missing, which + " has ended", "wait until it is up again");
  return fail(Errc::not_permitted, which + " is another user's process", "run trb reload as its user");
}

}  // namespace trb::supervisor
