#include "services/cli/io/probe.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "common/base/files.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "services/cli/io/node_folder.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

/// By then a router that is there has taken the connection, even if it stands still.
constexpr Duration kReachedWithin = std::chrono::seconds(2);

/// Why the router has not taken the probe.
Error not_welcome(op::BusSession& bus, const std::string& key, const std::string& node_dir) {
  if (bus.key_refused()) {
    return fail(Errc::wrong_key, "the bus of " + node_dir + " does not take the key keys/bus/" + key + ".key",
                "copy keys/bus/" + key + ".key and router.pub from where its router runs");
  }
  if (!bus.refusal().empty()) {
    return fail(Errc::conflict, "the router of " + node_dir + " refuses: " + bus.refusal(),
                "end other trb commands on this node, then try again");
  }
  if (bus.was_reached()) {
    return fail(Errc::timeout, "the router of " + node_dir + " runs, but does not answer",
                "try again; if it stands still, start the node anew: trb down " + node_dir + ", trb up " + node_dir);
  }
  return fail(Errc::timeout, "the router of " + node_dir + " does not answer", "start the node: trb up " + node_dir);
}

}  // namespace

namespace {

std::string named_node(const Arguments& arguments) {
  std::string dir = arguments.get("--node");
  if (!dir.empty()) return dir;
  const char* set = std::getenv("TRB_NODE");  // NOLINT(concurrency-mt-unsafe): one thread
  return set == nullptr ? "" : set;
}

}  // namespace

bool is_node_named(const Arguments& arguments) {
  return !named_node(arguments).empty();
}

Result<std::string> find_node(const Arguments& arguments) {
  std::string dir = named_node(arguments);
  if (dir.empty() && file_exists("node.json")) return std::string(1, '.');
  if (dir.empty())
    return fail(Errc::missing, "which node?", "give --node NODE_DIR, set TRB_NODE, or go into a node's folder");
  if (const Status there = find_node_json(dir, "name a node's folder"); !there) return there.error();
  return dir;
}

Result<std::unique_ptr<Probe>> Probe::open(const std::string& node_dir, Duration wait) {
  if (::chdir(node_dir.c_str()) != 0) return fail(Errc::missing, node_dir + ": no such folder", "name a node's folder");
  return welcomed(op::BusSession::open("cli"), "probe", node_dir, wait);
}

Result<std::unique_ptr<Probe>> Probe::visit(const std::string& service, Duration wait) {
  return welcomed(op::BusSession::visit(service), service, ".", wait);
}

Result<std::unique_ptr<Probe>> Probe::welcomed(Result<std::unique_ptr<op::BusSession>> bus, const std::string& key,
                                               const std::string& node_dir, Duration wait) {
  if (!bus) return bus.error();
  std::unique_ptr<Probe> probe(new Probe(std::move(*bus)));
  probe->wait_welcome(wait);
  if (!probe->bus_->is_up()) return not_welcome(*probe->bus_, key, node_dir);
  return probe;
}

void Probe::wait_welcome(Duration wait) {
  const MonotonicTime begin = read_clocks().mono;
  const Duration first = std::min(wait, kReachedWithin);
  session().after(first, [] {});
  session().after(wait, [] {});
  wait_until([&] {
    const Duration waited = read_clocks().mono - begin;
    return bus_->is_up() || bus_->key_refused() ||
           waited >= (bus_->was_reached() && bus_->refusal().empty() ? wait : first);
  });
}

void Probe::wait_until(const std::function<bool()>& condition) {
  while (!condition()) bus_->loop().turn();
}

Result<Message> Probe::command(const std::string& target, Body body) {
  return wait<Message>(
      [&](op::Session& session, const op::Callback<Message>& done) { session.command(target, std::move(body), done); });
}

Result<RouteTable> Probe::routes() {
  return wait<RouteTable>(
      [](op::Session& session, const op::Callback<RouteTable>& done) { op::request_routes(session, done); });
}

Error Probe::with_nearest(Error error, const std::string& target, bool any_node) {
  if (error.code != Errc::unknown_target) return error;
  const auto table = routes();
  if (!table) return error;
  std::vector<std::string> known = op::robots_of(*table);
  if (any_node) {
    known.clear();
    for (const Route& route : table->routes) known.push_back(route.id);
  }
  const std::string near = nearest(target, known);
  if (!near.empty()) error.hint = "did you mean '" + near + "'?";
  return error;
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
