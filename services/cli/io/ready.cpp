#include "services/cli/io/ready.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "common/base/files.hpp"
#include "common/config/node_config.hpp"
#include "common/supervisor/node_lock.hpp"
#include "common/transport/loop.hpp"

namespace trb::cli {
namespace {

constexpr auto kLook = std::chrono::milliseconds(100);
constexpr std::uintmax_t kMaxLog = 1U << 20U;

std::string log_of(const std::string& node_dir) {
  return node_dir + "/log/up.log";
}

/// "scheduler waits: the disk of ... is full"
std::string note_of(const ServiceEntry& entry) {
  const bool waits = entry.note.starts_with(kWaitsNote);
  return entry.service + (waits ? " waits: " + entry.note.substr(kWaitsNote.size()) : " notes: " + entry.note);
}

}  // namespace

bool ReadyCheck::operator()() {
  waits_for_ = "its router does not answer";
  if (!probe_) {
    // The file of a socket outlasts its router, and over TCP nobody can see whether it is there: a short wait does not
    // hold up the supervisor.
    const auto bus = read_bus(dir_);
    if (!bus || (bus->empty() && !file_exists(dir_ + "/bus/probe.ipc"))) return false;
    auto probe = Probe::open(dir_, std::chrono::milliseconds(250));
    if (!probe) return false;
    probe_ = std::move(*probe);
  }
  auto table = probe_->ask_node<ServiceTable>(ServiceListRequest{}, std::chrono::milliseconds(200));
  if (!table) return false;
  waits_for_.clear();
  notes_.clear();
  for (const ServiceEntry& entry : table->services) {
    if (!entry.note.empty()) notes_.push_back(note_of(entry));
    if (entry.state != "up") waits_for_ += (waits_for_.empty() ? "not up: " : ", ") + entry.service;
  }
  if (!waits_for_.empty()) return false;
  probe_.reset();
  return true;
}

Result<std::vector<std::string>> wait_ready(const std::string& dir, pid_t supervisor, Duration wait) {
  const MonotonicTime end = read_clocks().mono + wait;
  ReadyCheck ready(dir);
  while (!ready()) {
    int status = 0;
    if (::waitpid(supervisor, &status, WNOHANG) == supervisor) {
      return fail(Errc::conflict, dir + ": its supervisor has ended", "see " + log_of(dir));
    }
    if (read_clocks().mono >= end) {
      return fail(
          Errc::timeout,
          dir + " is not ready: " + ready.waits_for() + "; it goes on trying (pid " + std::to_string(supervisor) + ")",
          "see trb logs " + dir + " and trb doctor --node " + dir + "; end it with trb down " + dir);
    }
    std::this_thread::sleep_for(kLook);
  }
  return ready.notes();
}

void bound_log(const std::string& node_dir) {
  std::error_code none;
  const std::string log = log_of(node_dir);
  const auto size = std::filesystem::file_size(log, none);
  if (none || size <= kMaxLog) return;
  // The services write to this very file, at its end: it is emptied, not moved. On a full disk there is no copy.
  std::filesystem::copy_file(log, log + ".1", std::filesystem::copy_options::overwrite_existing, none);
  std::filesystem::resize_file(log, 0, none);
}

void leave_terminal(const std::string& node_dir) {
  ::setsid();
  (void)make_private_dir(node_dir + "/log");
  bound_log(node_dir);
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  int log = ::open(log_of(node_dir).c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (log < 0) log = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(log, STDOUT_FILENO);
  ::dup2(log, STDERR_FILENO);
  ::close(nothing);
  ::close(log);
}

bool wait_down(const std::string& dir, Duration wait) {
  const MonotonicTime end = read_clocks().mono + wait;
  for (;;) {
    const auto holder = supervisor::NodeLock::holder(dir);
    if (!holder && holder.error().code == Errc::missing) return true;
    if (read_clocks().mono >= end) return false;
    std::this_thread::sleep_for(kLook);
  }
}

}  // namespace trb::cli
