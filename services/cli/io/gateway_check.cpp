#include "services/cli/io/gateway_check.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "common/base/descriptor.hpp"
#include "common/base/files.hpp"
#include "common/supervisor/process.hpp"
#include "proto/value.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMaxAnswer = 64U << 10U;

/// What the program prints; empty: it could not be run.
std::string output_of(const std::string& program, const std::string& node_dir) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return "";
  const Descriptor from(ends[0]);
  Descriptor to(ends[1]);
  const pid_t self = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) return "";
  if (pid == 0) {
    supervisor::die_with_parent(self);
    ::dup2(to.get(), STDOUT_FILENO);
    ::execl(program.c_str(), program.c_str(), "--check-certificate", node_dir.c_str(), nullptr);
    ::_exit(127);
  }
  to = Descriptor();
  std::string out;
  std::array<char, 4096> buffer{};
  while (out.size() < kMaxAnswer) {
    const ssize_t count = ::read(from.get(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    out.append(buffer.data(), static_cast<std::size_t>(count));
  }
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? out : "";
}

std::string text_in(const Value& row, std::string_view key) {
  const Value* found = row.find(key);
  return found != nullptr && found->is_text() ? found->text() : "";
}

}  // namespace

ConfigFaults check_gateway_certificate(const std::string& node_dir) {
  const std::string program = supervisor::program_dir() + "/trb-cloud-gateway";
  if (!file_exists(program)) return {};
  const auto json = parse_json(output_of(program, node_dir));
  const Value* list = json ? json->find("faults") : nullptr;
  ConfigFaults out;
  if (list == nullptr || !list->is_list()) return out;
  for (const Value& row : list->list())
    out.push_back({text_in(row, "file"), "", text_in(row, "what"), text_in(row, "cure")});
  return out;
}

}  // namespace trb::cli
