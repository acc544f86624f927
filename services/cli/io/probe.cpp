#include "services/cli/io/probe.hpp"

#include <unistd.h>

#include <cstdlib>

#include "common/base/files.hpp"
#include "common/security/keys.hpp"
#include "common/service/version.hpp"
#include "common/transport/loop.hpp"
#include "services/cli/core/answers.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
Result<std::string> find_node(const Arguments& arguments) {
  std::string dir = arguments.get("--node");
  if (dir.empty()) {
    const char* set = std::getenv("TRB_NODE");  // NOLINT(concurrency-mt-unsafe): one thread
    if (set != nullptr) dir = set;
  }
  if (dir.empty() && file_exists("node.json")) dir = ".";
  if (dir.empty())
    return fail(Errc::missing, "which node?", "give --node NODE_DIR, set TRB_NODE, or go into a node's folder");
  if (!file_exists(dir + "/node.json"))
    return fail(Errc::missing, dir + ": no node.json there", "name a node's folder");
  return dir;
}

Probe::Probe(const BusAddress& bus) {
  const auto pid = static_cast<std::uint32_t>(::getpid());
  link_ = std::make_unique<BusLink>(context_, bus, ServiceHello{"cli", {}, random_u64(), pid, kVersion});
}

Result<std::unique_ptr<Probe>> Probe::open(const std::string& node_dir, Duration wait) {
  init_crypto();
  if (::chdir(node_dir.c_str()) != 0) return fail(Errc::missing, node_dir + ": no such folder", "name a node's folder");
  auto bus = bus_address("probe");
  if (!bus) return bus.error();
  std::unique_ptr<Probe> probe(new Probe(*bus));
  if (Status welcome = probe->wait_welcome(wait); !welcome) {
    if (probe->link_->key_refused()) {
      return fail(Errc::wrong_key, "the bus of " + node_dir + " does not take the key keys/bus/probe.key",
                  "copy keys/bus/probe.key and router.pub from where its router runs");
    }
    if (const std::string& refusal = probe->link_->refusal(); !refusal.empty()) {
      return fail(Errc::conflict, "the router of " + node_dir + " refuses: " + refusal,
                  "end other trb commands on this node, then try again");
    }
    return fail(Errc::timeout, "the router of " + node_dir + " does not answer", "start the node: trb up " + node_dir);
  }
  return probe;
}

Status Probe::wait_welcome(Duration wait) {
  const MonotonicTime end = read_clocks().mono + wait;
  while (!link_->up()) {
    if (link_->key_refused() || read_clocks().mono >= end) return fail(Errc::timeout, "no welcome");
    receive(std::chrono::milliseconds(20));
  }
  return Done{};
}

std::optional<Message> Probe::receive(Duration wait) {
  const MonotonicTime end = read_clocks().mono + wait;
  for (;;) {
    const Now now = read_clocks();
    link_->tick(now);
    if (auto message = link_->receive(now)) return message;
    const Duration left = end - now.mono;
    if (left <= Duration::zero()) return std::nullopt;
    const Duration turn = std::min<Duration>(left, std::chrono::milliseconds(100));
    zmq::pollitem_t item{link_->handle(), 0, ZMQ_POLLIN, 0};
    zmq::poll(&item, 1, std::chrono::ceil<std::chrono::milliseconds>(turn));
  }
}

Result<Message> Probe::ask(const Send& send, Duration wait) {
  const auto sent = link_->send(send);
  if (!sent) return sent.error();
  const std::uint64_t id = *sent;
  if (id == 0) return fail(Errc::queue_full, "the router takes no message now", "see trb service list");
  const MonotonicTime end = read_clocks().mono + wait;
  for (;;) {
    const Duration left = end - read_clocks().mono;
    if (left <= Duration::zero()) {
      return fail(Errc::timeout, "no answer from '" + send.target + "' to " + std::string(subtype_of(send.body)),
                  "see trb route list and trb service list");
    }
    auto message = receive(left);
    if (!message || !answers(*message, id, send.target)) continue;
    if (message->subtype != Nack::kSubtype) return std::move(*message);
    auto nack = decode<Nack>(message->data);
    if (!nack) return nack.error();
    return nack_error(*nack);
  }
}

Result<RouteTable> Probe::ask_routes(Duration wait) {
  RoutePages pages;
  RouteListRequest question;
  for (;;) {
    auto answer = ask(Send{.type = MessageType::request, .target = node(), .body = question}, wait);
    if (!answer) return answer.error();
    auto page = decode<RouteTable>(answer->data);
    if (!page) return page.error();
    auto taken = pages.take(std::move(*page));
    if (taken.whole) return std::move(*taken.whole);
    if (!taken.next) return fail(Errc::conflict, "the router of '" + node() + "' tells another page than it was asked");
    question = std::move(*taken.next);
  }
}

namespace {

/// For a Nack that tells none: what to look at, in the words of this program.
std::string usual_cure(Errc code) {
  switch (code) {
    case Errc::unknown_run:
      return "see trb scenario list";
    case Errc::fenced:
      return "trb release ROBOT lifts the fence";
    case Errc::robot_offline:
      return "see trb robot list; start the robot or check its cable";
    case Errc::unknown_skill:
    case Errc::unknown_place:
      return "see trb route list --json for what the robot can do";
    default:
      return "see trb help errors";
  }
}

}  // namespace

Error nack_error(const Nack& nack) {
  for (int code = 1; code < 256; ++code) {
    const auto known = static_cast<Errc>(code);
    if (errc_name(known) == nack.code) return fail(known, nack.what, nack.cure.empty() ? usual_cure(known) : nack.cure);
  }
  return fail(Errc::bad_value, nack.code + ": " + nack.what, nack.cure);
}

std::unique_ptr<Probe> open_probe(const Arguments& arguments) {
  auto dir = find_node(arguments);
  if (!dir) {
    print_error(arguments, dir.error());
    return nullptr;
  }
  auto probe = Probe::open(*dir);
  if (probe) return std::move(*probe);
  print_error(arguments, probe.error());
  return nullptr;
}

}  // namespace trb::cli
