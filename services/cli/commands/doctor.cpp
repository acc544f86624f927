// doctor: looks at a node's folder, services, links and robot, and names what is wrong.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "common/drivers/registry.hpp"
#include "common/operator/doctor/service_findings.hpp"
#include "common/operator/io/doctor.hpp"
#include "common/operator/io/machine_state.hpp"
#include "common/transport/loop.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

using op::Finding;
using op::Observed;
using op::Weight;

/// Says on a terminal what is being waited for.
void progress(const Arguments& arguments, const std::string& text) {
  if (!arguments.has("--json") && ::isatty(STDERR_FILENO) == 1) print_problem("trb: " + text + " ...\n");
}

Value to_value(const Finding& finding) {
  return Value{Value::Object{{"severity", Value{finding.weight == Weight::problem ? "problem" : "note"}},
                             {"cause", Value{finding.cause}},
                             {"subject", Value{finding.subject}},
                             {"what", Value{finding.what}},
                             {"cure", Value{finding.hint}}}};
}

/// What a node is whose examination found no problem.
std::string wellness(const Observed& seen) {
  const auto online = std::count_if(seen.routes.routes.begin(), seen.routes.routes.end(),
                                    [](const Route& route) { return route.state == "ONLINE"; });
  return "services up, linked with " + std::to_string(online) + (online == 1 ? " node" : " nodes");
}

int report(const Arguments& arguments, const op::Examination& examination, const std::string& wellness) {
  const auto& [seen, findings] = examination;
  const bool well = std::none_of(findings.begin(), findings.end(),
                                 [](const Finding& finding) { return finding.weight == Weight::problem; });
  if (arguments.has("--json")) {
    Value::List list;
    for (const Finding& finding : findings) list.push_back(to_value(finding));
    print_json(
        Value{Value::Object{{"node", Value{seen.node}}, {"well", Value{well}}, {"findings", Value{std::move(list)}}}});
    return well ? kGood : kFailed;
  }
  for (const Finding& finding : findings) {
    const bool problem = finding.weight == Weight::problem;
    print_line(coloured(problem ? Colour::bad : Colour::plain, problem ? "problem" : "note   ") + "  " +
               finding.subject + ": " + finding.what + "  [" + finding.cause + "]");
    print_line("         -> " + finding.hint);
  }
  if (well) print_line(coloured(Colour::good, "well     ") + seen.node + ": " + wellness + ", no problem found");
  return well ? kGood : kFailed;
}

/// The node's folder is the working directory by now.
op::Examination examine(const Arguments& arguments) {
  Result<std::unique_ptr<Probe>> probe = Probe::open(".");
  Loop alone;  // without a router
  Loop& loop = probe ? (*probe)->bus().loop() : alone;
  op::Doctor doctor(loop, probe ? &(*probe)->session() : nullptr, &drivers::robot_transports());
  std::optional<op::Examination> out;
  doctor.examine({arguments.words.empty() ? "" : arguments.words[0], !probe && probe.error().code == Errc::wrong_key},
                 {[&](const std::string& text) { progress(arguments, text); },
                  [&](op::Examination examination) { out = std::move(examination); }});
  while (!out) loop.turn();
  return std::move(*out);
}

/// One service, by its own key: its container has no other.
op::Examination examine_service(const std::string& service) {
  op::Examination out;
  NodeCheck check = check_node_dir(".", true, drivers::robot_transports());
  out.seen.node = check.config.id;
  out.seen.faults = std::move(check.faults);
  out.seen.named = check.config.services;
  out.seen.disk = disk_state(".");
  out.seen.clock_set = op::is_clock_set();
  Result<std::unique_ptr<Probe>> visit = Probe::visit(service);
  out.seen.bus_key_refused = !visit && visit.error().code == Errc::wrong_key;
  auto table = visit ? (*visit)->ask_node<ServiceTable>(ServiceListRequest{}) : Result<ServiceTable>(visit.error());
  out.seen.answers = table.ok();
  if (table) out.seen.services = std::move(*table);
  out.findings = op::diagnose_service(out.seen, service);
  return out;
}

int run_doctor(const Arguments& arguments) {
  auto dir = find_node(arguments);
  if (!dir) return print_error(arguments, dir.error());
  if (::chdir(dir->c_str()) != 0)
    return print_error(arguments, fail(Errc::missing, *dir + ": no such folder", "name a node's folder"));
  const std::string service = arguments.get("--service");
  if (!service.empty() && !arguments.words.empty()) {
    print_problem("trb: doctor looks at --service or at a PEER, not at both; leave one away\n");
    return kWrongUse;
  }
  if (!service.empty()) return report(arguments, examine_service(service), service + " is up");
  const op::Examination examination = examine(arguments);
  return report(arguments, examination, wellness(examination.seen));
}

const std::vector<Command> kDoctorCommands = {
    {{"doctor"},
     {"doctor [PEER]",
      "Looks at the node's files, services, links and robot, and names what is wrong and the cure. PEER is an id or\n"
      "HOST:PORT: looks at that one alone, also if it is not known. --service looks at one service, by the service's\n"
      "own key of the bus, for a container that has no other. Exit status 0: no problem found.",
      {"--service NAME|this service of the node alone",
       "--node DIR|the node to look at (else TRB_NODE, else this folder)", kJson},
      {"trb doctor --node nodes/ur3", "trb doctor ridgeback", "trb doctor 10.0.2.7:45000 --json",
       "trb doctor --service scheduler --node /node"},
      0,
      1},
     run_doctor},
};

}  // namespace

std::vector<Command> doctor_commands() {
  return kDoctorCommands;
}

}  // namespace trb::cli
