#include "common/operator/doctor/diagnosis.hpp"

#include <algorithm>
#include <set>

#include "common/base/address.hpp"
#include "common/config/robot_auth.hpp"
#include "common/config/robot_tls.hpp"
#include "common/operator/doctor/causes.hpp"
#include "common/operator/doctor/certificate_findings.hpp"
#include "common/operator/doctor/machine_findings.hpp"
#include "common/operator/doctor/service_findings.hpp"
#include "common/operator/doctor/shared_keys_findings.hpp"
#include "common/operator/doctor/use_findings.hpp"

namespace trb::op {
namespace {

/// Errors of strangers longer ago than this explain nothing of the present state.
constexpr double kRecent = 120;

class Doctor {
 public:
  explicit Doctor(const Observed& seen) : seen_(seen) {}

  std::vector<Finding> examine() && {
    own_folder();
    add_certificate_findings(seen_, out_);
    add_machine_findings(seen_, out_);
    own_services();
    robot();
    add_use_findings(seen_, out_);
    for (const Route& route : seen_.routes.routes) node(route);
    seeds();
    asked();
    strangers();
    add_shared_keys_findings(seen_, out_);
    std::stable_sort(out_.begin(), out_.end(), [](const Finding& a, const Finding& b) { return a.weight > b.weight; });
    return std::move(out_);
  }

 private:
  void add(Weight weight, std::string_view cause, const std::string& subject, std::string what, std::string hint) {
    const bool told = std::any_of(out_.begin(), out_.end(),
                                  [&](const Finding& f) { return f.cause == cause && f.subject == subject; });
    if (!told) out_.push_back({weight, std::string(cause), subject, std::move(what), std::move(hint)});
  }
  void problem(std::string_view cause, const std::string& subject, std::string what, std::string hint) {
    add(Weight::problem, cause, subject, std::move(what), std::move(hint));
  }
  void note(std::string_view cause, const std::string& subject, std::string what, std::string hint) {
    add(Weight::note, cause, subject, std::move(what), std::move(hint));
  }

  void own_folder() {
    for (const ConfigFault& fault : seen_.faults) {
      const Finding one = finding_of(fault);
      problem(one.cause, one.subject, one.what, one.hint);
    }
    if (seen_.beacon || seen_.seeds != 0) return;
    const char* cure = "set \"beacon\" to true, or name a node in \"seeds\"";
    const bool is_linked = std::ranges::any_of(seen_.routes.routes, [](const Route& r) { return r.state == "ONLINE"; });
    if (is_linked) {
      note("no_way", "node.json", "beacons are off and no seed is named: who does not dial this node is not found",
           cure);
    } else {
      problem("no_way", "node.json", "beacons are off and no seed is named: no other node can be found", cure);
    }
  }

  void own_services() {
    for (const std::string& path : seen_.missing_sockets) {
      if (!seen_.answers && !seen_.inbox_open) break;  // the router is not there: that is the cause
      if (path.starts_with("tcp://")) {
        problem(
            "bus_socket_missing", path, "the router runs, but its bus does not take connections there",
            "restart the node if \"bus\" in node.json was changed; look for a firewall between here and its machine");
        continue;
      }
      problem("bus_socket_missing", path, "the router runs, but this socket of its bus is gone: something removed it",
              "restart the node: trb up makes it again; see that nothing cleans that folder");
    }
    if (seen_.bus_key_refused) {
      return problem("bus_key", "keys/bus/probe.key", "the router's bus does not take this key of trb",
                     "copy keys/bus/probe.key from where its router runs; if it is the node itself: restart the node");
    }
    if (!seen_.answers) {
      if (!seen_.inbox_open || seen_.missing_sockets.empty())
        problem("router_down", seen_.node, "its router does not answer on the bus", "start the node: trb up NODE_DIR");
      return;
    }
    add_missing_adapter(seen_, out_);
    for (const ServiceEntry& entry : seen_.services.services) {
      if (entry.state != "up")
        problem("service_down", entry.service, "the service is " + entry.state,
                "see trb logs NODE_DIR " + entry.service);
      if (entry.state == "up" && entry.service == "scheduler") scheduler_waits();
      if (entry.note.starts_with(kWaitsNote)) {
        problem("service_waits", entry.service, entry.note, std::string(kWaitsHint));
      } else if (!entry.note.empty()) {
        note("service_note", entry.service, entry.note, "see trb service list");
      }
    }
  }

  /// It is there, and refuses: its files cannot be opened. Its own answer has more words than its note.
  void scheduler_waits() {
    if (!seen_.no_runs || seen_.no_runs->code != Errc::no_service) return;
    problem("service_waits", "scheduler", seen_.no_runs->what, seen_.no_runs->hint);
  }

  void robot() {
    const Route* self = find(seen_.node);
    if (self == nullptr || self->profile.robot.empty() || self->profile.robot == "ONLINE") return;
    const bool unreported = std::ranges::any_of(seen_.services.services, [](const ServiceEntry& entry) {
      return entry.service == "mode-adapter" && entry.state != "up";
    });
    if (unreported) return;  // that is the cause, and has been told
    std::string what = "the robot is " + self->profile.robot;
    if (!self->profile.detail.empty()) what += ": " + self->profile.detail;
    // Somebody answers there: its power and its cable are good.
    if (what.find(kSignInRefused) != std::string::npos)
      return problem("robot_silent", seen_.node, std::move(what), kSignInCure);
    if (what.find(kNotAllowed) != std::string::npos)
      return problem("robot_silent", seen_.node, std::move(what), kNotAllowedCure);
    if (what.find(kTlsFailed) != std::string::npos)
      return problem("robot_silent", seen_.node, std::move(what), kTlsCure);
    std::string hint = "start its program that connects to TCP_PORT of this node";
    if (!seen_.robot.address.empty()) {
      const std::string at = seen_.robot.address;
      if (seen_.robot.port == Port::refused) {
        hint = "nothing listens at " + at + ": start the robot's controller, or correct its port in commands.json";
      } else if (seen_.robot.port == Port::no_answer || seen_.robot.port == Port::no_route) {
        hint = "nothing answers at " + at + ": look at its power and cable, and at robot.host in node.json";
      } else if (what.find("closed by the device") != std::string::npos) {
        hint = at + " closes the connection at once: has it another client (a panel, a second node)?";
      } else {
        hint =
            at +
            " takes connections but the robot says nothing: is it in remote mode? see trb logs NODE_DIR mode-adapter";
      }
    }
    problem("robot_silent", seen_.node, std::move(what), std::move(hint));
  }

  const Route* find(const std::string& id) const {
    const auto at = std::ranges::find(seen_.routes.routes, id, &Route::id);
    return at == seen_.routes.routes.end() ? nullptr : &*at;
  }

  const AddressProbe* probe_of(const std::string& address) const {
    for (const AddressProbe& probe : seen_.addresses) {
      if (probe.address == address) return &probe;
    }
    return nullptr;
  }

  /// The router is asked, too: no file in this node's folder shows that it is revoked.
  void own_membership(const std::string& id) {
    for (const LinkErrorRow& row : seen_.errors.errors) {
      const bool own = row.peer == id && row.code.starts_with("own.");
      const Cause* cause = own ? cause_of(row.code.substr(4)) : nullptr;
      if (cause != nullptr) problem(cause->cause, id, row.text, std::string(cause->hint));
    }
  }

  bool is_asked(const std::string& id, const std::string& address) const {
    return seen_.asked.empty() || seen_.asked == id || seen_.asked == address;
  }

  void node(const Route& route) {
    const Route* self = find(seen_.node);
    if (route.state == "self") {
      own_membership(route.id);
      if (route.clock == "unverified")
        problem("clock_off", route.id, "this node's clock is not to be believed", "set it: timedatectl, or NTP");
      return;
    }
    if (!is_asked(route.id, route.address)) return;
    errors_of(route.id, route.address, route.state == "ONLINE");
    if (self != nullptr && !route.version.empty() && route.version != self->version) {
      note("versions_apart", route.id, "it runs " + route.version + ", this node " + self->version,
           "install the same release on both");
    }
    if (route.state != "ONLINE") return unreached(route.id, route.address);
    if (!route.via.empty()) return relayed(route);
    for (const EchoProbe& echo : seen_.echoes) {
      if (echo.peer == route.id) linked(route, echo);
    }
  }

  void linked(const Route& route, const EchoProbe& echo) {
    const AddressProbe* probe = probe_of(route.address);
    if ((echo.small && !echo.large) || (probe != nullptr && probe->large == LargeDatagram::lost)) {
      too_large(route.id);
    } else if (!echo.small) {
      problem("silent", route.id, "linked, but its router did not answer an echo",
              "see trb route list in a few seconds");
    }
  }

  void too_large(const std::string& subject) {
    problem(
        "mtu", subject, "small messages pass, large ones are lost on the way: a path with a smaller MTU",
        "set the MTU of this node's interface to the path's (ip link set INTERFACE mtu 1400), or let the VPN clamp it");
  }

  void relayed(const Route& route) {
    const AddressProbe* probe = probe_of(route.address);
    const bool elsewhere = probe != nullptr && !probe->own_subnet && !probe->seed;
    note(elsewhere ? "other_subnet" : "relayed", route.id,
         "reached by way of " + route.via + " only: " +
             (elsewhere ? route.address + " is in another subnet, where no beacon arrives, and no seed names it"
                        : "neither of the two can dial the other"),
         elsewhere ? "if there is a way, add to \"seeds\" in node.json: {\"address\":\"" + route.address +
                         "\",\"key\":\"…\"}; the key is shown there by trb fleet show NODE_DIR"
                   : "open TCP_PORT_EXT in the firewall of one of them, if messages should go directly");
  }

  /// The errors that the router recorded; true if they name a cause.
  bool errors_of(const std::string& id, const std::string& address, bool online) {
    bool named = false;
    for (const LinkErrorRow& row : seen_.errors.errors) {
      const bool of_it = (!id.empty() && row.peer == id) || (!address.empty() && row.address == address);
      if (!of_it || (online && row.code != "clock_off" && row.last_s > kRecent)) continue;
      named = add_cause_of(row, id.empty() ? address : id, online) || named;
    }
    if (named) named_.insert(id.empty() ? address : id);
    return named;
  }

  bool add_cause_of(const LinkErrorRow& row, const std::string& subject, bool online) {
    if (row.code == "refused_us") {
      const Cause* cause = cause_of(row.text);
      if (cause == nullptr) {
        problem("refused", subject, "it refuses this node: " + row.text, "see the log of its router");
      } else {
        problem(cause->cause, subject, "it refuses this node: by its view " + std::string(cause->what),
                "seen from there: " + std::string(cause->hint));
      }
      return true;
    }
    if (row.code == "refused_key") {
      problem("refused", subject, "its router does not let this node's key in (revoked, or refused a moment ago)",
              "see trb service counters router there: refused.*");
      return true;
    }
    const Cause* cause = cause_of(row.code);
    if (cause == nullptr) return false;
    add(online ? Weight::note : Weight::problem, cause->cause, subject,
        cause->what.empty() ? row.text : std::string(cause->what) + " (" + row.text + ")", std::string(cause->hint));
    return true;
  }

  /// Whether a dial reached a machine that speaks ZMTP and ended there.
  bool fails_at_handshake(const std::string& id, const std::string& address) const {
    return std::any_of(seen_.errors.errors.begin(), seen_.errors.errors.end(), [&](const LinkErrorRow& t) {
      const bool of_it = (!id.empty() && t.peer == id) || t.address == address;
      return of_it && (t.code == "failed" || t.code == "wrong_server_key" || t.code == "disconnected");
    });
  }
  bool says_no_hello(const std::string& id, const std::string& address) const {
    return std::any_of(seen_.errors.errors.begin(), seen_.errors.errors.end(), [&](const LinkErrorRow& t) {
      return ((!id.empty() && t.peer == id) || t.address == address) && t.code == "no_hello";
    });
  }

  void unreached(const std::string& id, const std::string& address) {
    const std::string subject = id.empty() ? address : id;
    const AddressProbe* probe = probe_of(address);
    if (probe == nullptr || named_.count(subject) != 0) return;
    const std::string at = id.empty() ? "" : " at " + address;
    switch (probe->port) {
      case Port::refused:
        return problem("port_closed", subject, "the machine" + at + " is there, but nothing listens on that port",
                       "start the node there (trb up); is TCP_PORT_EXT in its network.json the port that is dialled?");
      case Port::not_zmtp:
        return problem("port_taken", subject, "something" + at + " takes connections, but it is no router",
                       "another program has that port: change TCP_PORT_EXT there");
      case Port::no_answer:
      case Port::no_route:
        if (!probe->own_subnet && !probe->seed && probe->port == Port::no_route) {
          return problem("other_subnet", subject,
                         address + " is in another subnet, and this machine knows no way to it",
                         "set a route (ip route) or join the VPN, and name the node in \"seeds\"");
        }
        return problem("no_answer", subject, "nothing answers" + (at.empty() ? " there" : at),
                       "look at its power and cable; ping it; a firewall that drops says nothing either");
      case Port::zmtp:
        return speaks(id, address, *probe);
      case Port::not_tried:  // a host name: only its router looks it up
        if (is_numeric_endpoint(address)) return;
        if (fails_at_handshake(id, address) || says_no_hello(id, address))
          problem("no_answer", subject, "its name was found, but no link comes of the dial" + at,
                  "is it up there, and is the key in \"seeds\" its own (trb fleet show NODE_DIR)? then look at its "
                  "address: getent hosts NAME");
        return;
    }
  }

  void speaks(const std::string& id, const std::string& address, const AddressProbe& probe) {
    const std::string subject = id.empty() ? address : id;
    if (probe.large == LargeDatagram::lost) return too_large(subject);
    if (says_no_hello(id, address)) {
      return problem("mtu", subject, "the handshake succeeds, then nothing comes: most often a path with a smaller MTU",
                     "try ping -M do -s 1400 HOST; set a smaller MTU on this node's interface");
    }
    if (fails_at_handshake(id, address)) {
      return problem("wrong_key", subject,
                     "a router answers at " + address + ", but not with the key that this node has for it",
                     "run trb fleet show NODE_DIR there and put its link key into \"seeds\" of node.json here");
    }
    problem("not_linked", subject, "a router answers at " + address + ", a link is not up yet",
            "wait a few seconds; then see trb logs NODE_DIR router");
  }

  void seeds() {
    for (const AddressProbe& probe : seen_.addresses) {
      const bool known = std::any_of(seen_.routes.routes.begin(), seen_.routes.routes.end(),
                                     [&](const Route& route) { return route.address == probe.address; });
      if (!probe.seed || known || !is_asked(probe.address, probe.address)) continue;
      if (linked_by_seed(probe.address)) continue;
      errors_of("", probe.address, false);
      unreached("", probe.address);
    }
  }

  /// A seed may have another address than the node reports: then no error is left once it is linked.
  bool linked_by_seed(const std::string& address) const {
    return std::none_of(seen_.errors.errors.begin(), seen_.errors.errors.end(),
                        [&](const LinkErrorRow& row) { return row.address == address; });
  }

  void asked() {
    if (seen_.asked.empty() || seen_.asked == seen_.node) return;
    const bool known = std::any_of(seen_.routes.routes.begin(), seen_.routes.routes.end(), [&](const Route& route) {
      return route.id == seen_.asked || route.address == seen_.asked;
    });
    if (known) return;
    if (errors_of(seen_.asked, "", false)) return;  // a revoked node has no row in the table
    const AddressProbe* probe = probe_of(seen_.asked);
    if (probe == nullptr) {
      return problem("never_heard", seen_.asked, "no node with that id is known here",
                     "ask with its address (trb doctor HOST:PORT); is it up, in this subnet, of this fleet?");
    }
    if (probe->seed) return;  // reported with the seeds
    if (!probe->own_subnet) {
      return problem("other_subnet", seen_.asked,
                     "it is in another subnet, where no beacon arrives, and no seed names it",
                     "add to \"seeds\" in node.json: {\"address\":\"" + seen_.asked +
                         "\",\"key\":\"…\"}; the key is shown there by trb fleet show NODE_DIR");
    }
    unreached("", seen_.asked);
  }

  void strangers() {
    if (!seen_.asked.empty()) return;
    for (const LinkErrorRow& row : seen_.errors.errors) {
      if (row.last_s > kRecent || !row.address.empty() || find(row.peer) != nullptr) continue;
      const bool beacon = row.code.starts_with("beacon.");
      const std::string code = beacon ? row.code.substr(7) : row.code;
      const std::string subject = row.peer.empty() ? beacon ? "a beacon" : "a stranger" : row.peer;
      if (beacon && code == "wrong_key") {
        note("old_beacon_key", subject, "made with another beacon key: a node that was off when the key was changed",
             "it learns the new key by any link; name a seed in its node.json, or sign it again");
      } else if (const Cause* cause = cause_of(code)) {
        // That a known node is refused is a problem; an unknown one may not belong to this fleet.
        add(row.peer.empty() ? Weight::note : Weight::problem, cause->cause, subject,
            std::string(cause->what) + " (" + row.text + ")", std::string(cause->hint));
      }
    }
  }

  const Observed& seen_;
  std::vector<Finding> out_;
  std::set<std::string> named_;  ///< subjects whose cause the router has named
};

}  // namespace

std::vector<Finding> diagnose(const Observed& seen) {
  return Doctor(seen).examine();
}

}  // namespace trb::op
