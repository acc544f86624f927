#include "services/cloud-gateway/io/simulator_program.hpp"

#include <fcntl.h>

// glibc 2.36 has forgotten that this header may be read by C++.
extern "C" {
#include <sys/pidfd.h>
}
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "common/base/files.hpp"
#include "common/supervisor/memory_file.hpp"
#include "common/supervisor/process.hpp"
#include "proto/value.hpp"

namespace trb::gateway {
namespace {

constexpr int kNotStarted = 127;
constexpr int kLast = 19;  ///< nice: everything else goes first
constexpr rlim_t kMostMemory = 1U << 30U;
constexpr rlim_t kMostProcessor_s = 60;
constexpr std::size_t kMaxError = 16U << 10U;

/// What a sanitizer reserves of addresses is no memory, and more than any bound.
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define TRB_RESERVES_ADDRESSES
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TRB_RESERVES_ADDRESSES
#endif
#ifdef TRB_RESERVES_ADDRESSES
constexpr bool kIsBounded = false;
#else
constexpr bool kIsBounded = true;
#endif

using Pipe = std::array<int, 2>;

void close_both(const Pipe& pipe) {
  close(pipe[0]);
  close(pipe[1]);
}

/// Between fork and exec of a process with threads: calls of the kernel alone.
[[noreturn]] void become(const char* program, int job, const Pipe& answer, const Pipe& progress, pid_t parent) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGPIPE, SIGXCPU}) ::signal(signal, SIG_DFL);
  supervisor::die_with_parent(parent);
  setpgid(0, 0);
  setpriority(PRIO_PROCESS, 0, kLast);
  const rlimit most{kMostMemory, kMostMemory};
  const rlimit busy{kMostProcessor_s, kMostProcessor_s + 5};
  const bool is_bounded = setrlimit(RLIMIT_CPU, &busy) == 0 && (!kIsBounded || setrlimit(RLIMIT_AS, &most) == 0);
  const bool is_set = is_bounded && dup2(job, STDIN_FILENO) >= 0 && dup2(answer[1], STDOUT_FILENO) >= 0 &&
                      dup2(progress[1], STDERR_FILENO) >= 0;
  // Sockets of people and robots are none of its business.
  if (is_set && close_range(STDERR_FILENO + 1, ~0U, 0) == 0) execl(program, program, "--progress", "-", nullptr);
  _exit(kNotStarted);
}

}  // namespace

Result<SimulatorProgram> start_simulator(const std::string& job) {
  const Error no_room = fail(Errc::io_error, "a process for the simulation could not be started", "try again later");
  const std::string program = supervisor::program_dir() + "/trb-simulator";
  if (!file_exists(program)) {
    return fail(Errc::missing, "trb-simulator is not installed beside the gateway's program", "install it there");
  }
  Pipe answer{}, progress{};
  if (pipe2(answer.data(), O_CLOEXEC) != 0) return no_room;
  if (pipe2(progress.data(), O_CLOEXEC) != 0) {
    close_both(answer);
    return no_room;
  }
  const int input = supervisor::memory_file(job);
  const pid_t self = getpid();
  const pid_t pid = input < 0 ? -1 : fork();
  if (pid == 0) become(program.c_str(), input, answer, progress, self);
  if (input >= 0) close(input);
  const int exit = pid < 0 ? -1 : pidfd_open(pid, 0);
  if (exit < 0) {
    close_both(answer);
    close_both(progress);
    if (pid > 0) {
      kill(pid, SIGKILL);
      waitpid(pid, nullptr, 0);
    }
    return no_room;
  }
  close(answer[1]);
  close(progress[1]);
  return SimulatorProgram{pid, exit, answer[0], progress[0]};
}

Error simulator_failure(int status, const std::string& said) {
  if (WIFEXITED(status) && said.size() <= kMaxError) {
    const auto json = parse_json(said, {.bytes = kMaxError});
    const Value* error = json ? json->find("error") : nullptr;
    const auto text = [error](const char* key) {
      const Value* member = error->is_object() ? error->find(key) : nullptr;
      return member != nullptr && member->is_text() ? member->text() : std::string();
    };
    if (error != nullptr && !text("what").empty() && !text("cure").empty()) {
      return fail(errc_of(text("code")).value_or(Errc::bad_value), text("what"), text("cure"));
    }
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted) {
    return fail(Errc::io_error, "trb-simulator could not be started", "see that it may be run");
  }
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
    return fail(Errc::timeout, "it was not over after " + std::to_string(kMostProcessor_s) + " s of a processor",
                "use fewer robots or tasks; trb simulate takes as long as it needs");
  }
  return fail(Errc::io_error, "the simulation has ended before its end", "start it again, with fewer robots or tasks");
}

}  // namespace trb::gateway
