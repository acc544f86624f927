// trb-bench-fields: the robots of `scripts/bench fields` (tests/bench/README.md). Ends with its parent.
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "tests/bench/fields/reader.hpp"
#include "tests/bench/road/tcp_end.hpp"

namespace trb::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kHelp =
    "trb-bench-fields NODE FROM NAME NODE FROM NODE FROM\n\n"
    "  The robots of three nodes: the first sends, the second reads acknowledged lines, the third whatever comes "
    "between\n"
    "  two gaps. Each dials NODE from the address FROM; NAME is the id of the first one's node, the others are 'lines' "
    "and\n"
    "  'gap'. A line of standard input orders a run: TARGET MESSAGES WINDOW BUSY_MS EVERY_READS.\n\n"
    "Usually started by scripts/bench fields.";

constexpr int kPatienceMs = 10'000;

class Driver {
 public:
  Driver(int out, std::map<std::string, std::unique_ptr<Reader>> readers) : out_(out), readers_(std::move(readers)) {}

  void run(const std::string& target, std::uint64_t messages, std::uint64_t window, Slowness slowness) {
    Reader& reader = *readers_.at(target);
    std::uint64_t& first = sent_[target];
    reader.begin(slowness, first);
    std::uint64_t sent = 0;
    const auto begin = Clock::now();
    while (reader.tally().messages + reader.tally().lost < messages) {
      std::string bytes;
      const std::uint64_t heard = reader.tally().messages + reader.tally().lost;
      // By half windows, so that many messages share the work, as under load.
      if (sent - heard <= window / 2) {
        for (; sent < messages && sent - heard < window; ++sent) bytes += message(target, first + sent);
        send_all(bytes);
      }
      pollfd item{reader.fd(), POLLIN, 0};
      if (::poll(&item, 1, kPatienceMs) <= 0) break;  // the rest is lost
      reader.read();
    }
    const double took = std::chrono::duration<double>(Clock::now() - begin).count();
    first += sent;
    print(reader.tally(), messages, took);
  }

 private:
  static std::string message(const std::string& target, std::uint64_t number) {
    return "command\nmove\n" + target + "\n" + std::to_string(kDataSize) + "\n" + data_of(number) + "\n";
  }

  void send_all(const std::string& bytes) const {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t put = ::send(out_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (put <= 0) throw std::runtime_error("the sender's node does not take a message");
      done += static_cast<std::size_t>(put);
    }
  }

  static void print(const Tally& tally, std::uint64_t messages, double took) {
    const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
    std::printf(
        "{\"messages\":%llu,\"lost\":%llu,\"fields\":%llu,\"concatenated\":%llu,\"reads\":%llu,"
        "\"seconds\":%.3f,\"us_a_message\":%.2f}\n",
        number(tally.messages), number(messages - tally.messages), number(tally.fields), number(tally.concatenated),
        number(tally.reads), took, 1e6 * took / static_cast<double>(messages));
    std::fflush(stdout);
  }

  int out_;
  std::map<std::string, std::unique_ptr<Reader>> readers_;
  std::map<std::string, std::uint64_t> sent_;
};

int dial(const char* node, const char* from) {
  const int fd = tcp_dial(tcp_address(node), from);
  const int on = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return fd;
}

int run(char** words) {
  const std::string source = words[2];
  const int out = dial(words[0], words[1]);
  std::map<std::string, std::unique_ptr<Reader>> readers;
  readers["lines"] = acknowledging_reader(dial(words[3], words[4]), source);
  readers["gap"] = gap_reader(dial(words[5], words[6]), source);
  Driver driver(out, std::move(readers));
  std::puts("ready");
  std::fflush(stdout);
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream order(line);
    std::string target;
    std::uint64_t messages = 0, window = 0;
    Slowness slowness;
    order >> target >> messages >> window >> slowness.busy_ms >> slowness.every;
    if (!order || messages == 0 || window == 0) throw std::runtime_error("no order: " + line);
    driver.run(target, messages, window, slowness);
  }
  return 0;
}

}  // namespace
}  // namespace trb::bench

int main(int argc, char** argv) {
  constexpr int kWords = 8;
  if (argc != kWords) {
    std::puts(trb::bench::kHelp);
    return argc == 2 && std::string(argv[1]) == "--help" ? 0 : 2;
  }
  try {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    return trb::bench::run(argv + 1);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "trb-bench-fields: %s\n", problem.what());
    return 1;
  }
}
