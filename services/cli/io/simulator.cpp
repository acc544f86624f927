#include "services/cli/io/simulator.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>

#include "common/base/files.hpp"
#include "common/supervisor/memory_file.hpp"
#include "common/supervisor/process.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMaxAnswer = 16U << 20U;
constexpr std::size_t kMaxValues = 1'000'000;

struct Child {
  pid_t pid = -1;
  int output = -1;
};

Result<Child> start(const std::string& program, const std::string& job) {
  const int input = supervisor::memory_file(job);  // a fleet's job is longer than an argument may be
  if (input < 0) return fail(Errc::io_error, "a file in memory", "close other programs");
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) return fail(Errc::io_error, "a pipe", "close other programs");
  const pid_t self = getpid();
  const pid_t pid = fork();
  if (pid < 0) return fail(Errc::io_error, "a process", "close other programs");
  if (pid == 0) {
    supervisor::die_with_parent(self);
    dup2(input, STDIN_FILENO);
    dup2(pipe_ends[1], STDOUT_FILENO);
    execl(program.c_str(), program.c_str(), "-", nullptr);
    _exit(127);
  }
  close(input);
  close(pipe_ends[1]);
  return Child{pid, pipe_ends[0]};
}

std::string read_all(int descriptor) {
  std::string out;
  std::array<char, 65536> buffer{};
  while (out.size() <= kMaxAnswer) {
    const ssize_t count = read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    out.append(buffer.data(), static_cast<std::size_t>(count));
  }
  close(descriptor);
  return out;
}

}  // namespace

Result<Value> run_simulator(const Value& job) {
  const std::string program = supervisor::program_dir() + "/trb-simulator";
  if (!file_exists(program)) return fail(Errc::missing, program, "install it beside trb");
  const auto child = start(program, dump_json(job));
  if (!child) return child.error();
  const std::string text = read_all(child->output);
  int status = 0;
  while (waitpid(child->pid, &status, 0) < 0 && errno == EINTR) {
  }
  auto answer = parse_json(text, {.bytes = kMaxAnswer, .values = kMaxValues});
  const Value* error = answer ? answer->find("error") : nullptr;
  if (error != nullptr) {
    const Errc code = errc_of(error->find("code")->text()).value_or(Errc::bad_value);
    return fail(code, error->find("what")->text(), error->find("cure")->text());
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    return fail(Errc::io_error, "the simulation has ended before its end", "start it again");
  }
  return answer;
}

}  // namespace trb::cli
