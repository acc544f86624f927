#include "common/supervisor/process.hpp"

#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

namespace trb::supervisor {

std::string program_dir() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
}

void die_with_parent(pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  // The parent may have ended before this request.
  if (::getppid() != parent) ::raise(SIGTERM);
}

}  // namespace trb::supervisor
