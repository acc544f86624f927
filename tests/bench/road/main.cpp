// trb-bench-road: the processes of scripts/bench (tests/bench/README.md). Each ends with its parent.
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "tests/bench/bench_main.hpp"
#include "tests/bench/road/drive.hpp"
#include "tests/bench/road/relay.hpp"
#include "tests/bench/road/tcp_end.hpp"

namespace trb::bench {
namespace {

constexpr const char* kHelp =
    "trb-bench-road ROLE ARGUMENT...\n\n"
    "  drive-bus IN OUT                     robots as two services: ipc sockets of the first and the last relay\n"
    "  drive-tcp NODE FROM LISTEN [TARGET]  robots by TCP: dials NODE from the address FROM, listens on LISTEN;\n"
    "                                       with TARGET each message is the five fields of a command 'move'\n"
    "  tcp-bus LISTEN IPC                   a bare mode-adapter of the sender\n"
    "  bus-curve IPC ADDRESS KEY            a bare router of the sender\n"
    "  curve-bus ADDRESS IPC                a bare router of the receiver; prints its key\n"
    "  bus-plain IPC ADDRESS, plain-bus ADDRESS IPC    bare routers without encryption\n"
    "  bus-tcp IPC ADDRESS                  a bare mode-adapter of the receiver\n\n"
    "Usually started by scripts/bench. Example: trb-bench-road drive-bus a.ipc b.ipc";

using Words = std::vector<std::string>;

/// scripts/bench waits for this line before it starts the next process of the road.
void say_ready() {
  std::puts("ready");
  std::fflush(stdout);
}

int run_relay(End& in, End& out) {
  say_ready();
  relay(in, out);
}

int drive_bus(Context& context, const Words& words) {
  const auto out = bus_client(context, words[0]);
  const auto in = bus_client(context, words[1]);
  say_ready();
  drive(*out, *in);
  return 0;
}

int drive_tcp(const Words& words) {
  const int listener = tcp_listen(tcp_address(words[2]));
  const auto in = tcp_end(tcp_accept(listener), "");
  const std::string head = words.size() < 4 ? "" : "command\nmove\n" + words[3] + "\n48\n";
  const auto out = tcp_end(tcp_dial(tcp_address(words[0]), words[1]), head);
  say_ready();
  drive(*out, *in);
  return 0;
}

int tcp_bus(Context& context, const Words& words) {
  const auto out = bus_client(context, words[1]);
  const auto in = tcp_end(tcp_accept(tcp_listen(tcp_address(words[0]))), "");
  return run_relay(*in, *out);
}

int bus_curve(Context& context, const Words& words) {
  const auto out = curve_client(context, words[1], words[2]);
  const auto in = bus_server(context, words[0]);
  return run_relay(*in, *out);
}

int curve_bus(Context& context, const Words& words) {
  const auto out = bus_server(context, words[1]);
  const auto in = curve_server(context, words[0]);
  return run_relay(*in, *out);
}

int bus_plain(Context& context, const Words& words) {
  const auto out = plain_client(context, words[1]);
  const auto in = bus_server(context, words[0]);
  return run_relay(*in, *out);
}

int plain_bus(Context& context, const Words& words) {
  const auto out = bus_server(context, words[1]);
  const auto in = plain_server(context, words[0]);
  return run_relay(*in, *out);
}

int bus_tcp(Context& context, const Words& words) {
  const auto out = tcp_end(tcp_dial(tcp_address(words[1]), ""), "");
  const auto in = bus_client(context, words[0]);
  return run_relay(*in, *out);
}

int run(const std::string& role, const Words& words) {
  Context context;
  if (role == "drive-bus" && words.size() == 2) return drive_bus(context, words);
  if (role == "drive-tcp" && (words.size() == 3 || words.size() == 4)) return drive_tcp(words);
  if (role == "tcp-bus" && words.size() == 2) return tcp_bus(context, words);
  if (role == "bus-curve" && words.size() == 3) return bus_curve(context, words);
  if (role == "curve-bus" && words.size() == 2) return curve_bus(context, words);
  if (role == "bus-plain" && words.size() == 2) return bus_plain(context, words);
  if (role == "plain-bus" && words.size() == 2) return plain_bus(context, words);
  if (role == "bus-tcp" && words.size() == 2) return bus_tcp(context, words);
  std::puts(kHelp);
  return role == "--help" ? 0 : 2;
}

}  // namespace
}  // namespace trb::bench

int main(int argc, char** argv) {
  return trb::bench::bench_main("trb-bench-road", argc, argv, trb::bench::run);
}
