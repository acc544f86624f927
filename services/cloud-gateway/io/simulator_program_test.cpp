#include "services/cloud-gateway/io/simulator_program.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

using namespace trb;
using namespace trb::gateway;

namespace {

/// How a process ends that does this.
template <class Do>
int status_of(Do what) {
  const pid_t pid = fork();
  REQUIRE(pid >= 0);
  if (pid == 0) {
    what();
    _exit(1);
  }
  int status = 0;
  REQUIRE(waitpid(pid, &status, 0) == pid);
  return status;
}

}  // namespace

TEST_CASE("a simulation that the kernel has ended for its processor's time says that it was too large") {
  const int status = status_of([] {
    signal(SIGXCPU, SIG_DFL);
    const rlimit busy{1, 2};
    if (setrlimit(RLIMIT_CPU, &busy) != 0) return;
    for (volatile unsigned i = 0;; i = i + 1) {
    }
  });
  const Error why = simulator_failure(status, "");
  CHECK(why.code == Errc::timeout);
  CHECK(why.text().find("60 s of a processor") != std::string::npos);
  CHECK_FALSE(why.hint.empty());
}

TEST_CASE("a simulation that has ended otherwise says what it has printed, or that it has ended") {
  const int failed = status_of([] {});
  const Error said =
      simulator_failure(failed, R"({"error":{"code":"bad_value","what":"robots: 0","cure":"one at least"}})");
  CHECK(said.code == Errc::bad_value);
  CHECK(said.hint == "one at least");
  CHECK(simulator_failure(failed, "{").code == Errc::io_error);
  CHECK(simulator_failure(status_of([] { raise(SIGKILL); }), "").code == Errc::io_error);
}
