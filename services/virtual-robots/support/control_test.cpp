#include "services/virtual-robots/support/control.hpp"

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <poll.h>
#include <sys/socket.h>

using namespace trb::virtual_robots;

namespace {

/** Sends datagrams to a control port. */
class Sender {
 public:
  explicit Sender(const ControlPort& port) : port_(port) {
    socklen_t size = sizeof to_;
    ::getsockname(port.fd(), reinterpret_cast<sockaddr*>(&to_), &size);
  }

  void send(std::string_view bytes) {
    ::sendto(socket_.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
    pollfd entry{port_.fd(), POLLIN, 0};
    REQUIRE(::poll(&entry, 1, 5000) == 1);
  }

 private:
  const ControlPort& port_;
  sockaddr_in to_{};
  Fd socket_{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
};

}  // namespace

TEST_CASE("a control port takes each datagram as one line, and an empty one for what is none") {
  ControlPort port(Endpoint{"127.0.0.1", 0});
  Sender sender(port);
  sender.send("fault grab FATAL");
  CHECK(port.read() == std::vector<std::string>{"fault grab FATAL"});
  sender.send("clear\n");
  sender.send("");
  CHECK(port.read() == std::vector<std::string>{"clear", ""});
  sender.send("clear\nfault grab");
  sender.send(std::string(ControlPort::kLongestLine, 'x'));
  sender.send(std::string(ControlPort::kLongestLine + 1, 'x'));
  sender.send(std::string(10000, 'x'));
  const std::string longest(ControlPort::kLongestLine, 'x');
  CHECK(port.read() == std::vector<std::string>{"", longest, "", ""});
  CHECK(port.read().empty());
}

TEST_CASE("without --control there is no port") {
  CHECK(ControlPort(std::nullopt).fd() == -1);
}

TEST_CASE("--control: an address of four numbers and a port") {
  std::optional<Endpoint> where;
  const Option option = control_option(where);
  option.apply("127.0.2.2:6000");
  CHECK(where->port == 6000);
  for (const char* any : {"127.0.2.2:auto", "127.0.2.2:0"}) {
    option.apply(any);
    CHECK(where->address == "127.0.2.2");
    CHECK(where->port == 0);
  }
  for (const char* bad : {"", "6000", "127.0.2.2", "127.0.2.2:", "robot:6000", ":auto", "127.0.2.2:70000"}) {
    CHECK_THROWS_AS(option.apply(bad), OptionError);
  }
}

TEST_CASE("a fault has a capability, and a severity and a text where they are given") {
  CHECK_FALSE(parse_fault_order(""));
  CHECK(parse_fault_order("grab")->severity == "CRITICAL");
  const auto whole = parse_fault_order("mobile WARNING wheel 2\\nslips");
  CHECK(whole->capability == "mobile");
  CHECK(whole->severity == "WARNING");
  CHECK(whole->text == "wheel 2\nslips");
  CHECK_FALSE(parse_fault_order("mobile BAD a wheel slips"));
}
