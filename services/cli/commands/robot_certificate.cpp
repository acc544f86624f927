// robot certificate.
#include "services/cli/io/robot_certificate.hpp"
#include "common/config/node_config.hpp"
#include "common/config/robot_tls.hpp"
#include "common/drivers/registry.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

std::string pin_of(const PeerCertificate& certificate) {
  return R"("tls": {"fingerprint": ")" + certificate.fingerprint + "\"}";
}

void print_certificate(const ShownCertificate& shown) {
  const PeerCertificate& one = shown.certificate;
  print(format_table({{"subject", one.subject},
                      {"issuer", one.issuer},
                      {"names", joined(one.names, ", ")},
                      {"valid", "from " + one.from + " until " + one.until},
                      {"SHA-256", one.fingerprint}}));
  if (!shown.refused) return print_line("The node takes it.");
  print_line("The node does not take it: " + shown.refused->what);
  if (!shown.refused->hint.empty()) print_line("Cure: " + shown.refused->hint);
  print_line("To pin it, compare the fingerprint with the robot's own page, then write into commands.json: " +
             pin_of(one));
}

Value certificate_json(const ShownCertificate& shown) {
  const PeerCertificate& one = shown.certificate;
  Value::List names;
  for (const std::string& name : one.names) names.push_back(Value{name});
  return Value{Value::Object{{"subject", Value{one.subject}},
                             {"issuer", Value{one.issuer}},
                             {"names", Value{std::move(names)}},
                             {"from", Value{one.from}},
                             {"until", Value{one.until}},
                             {"sha256", Value{one.fingerprint}},
                             {"taken", Value{!shown.refused}},
                             {"refused", Value{shown.refused ? shown.refused->what : std::string()}}}};
}

int run_robot_certificate(const Arguments& arguments) {
  const NodeConfig config = check_node_dir(arguments.words[0], true, drivers::robot_transports()).config;
  if (config.robot.host.empty() || !config.commands.port) {
    return print_error(
        arguments, fail(Errc::missing, arguments.words[0] + ": no robot.host in node.json, or no port in commands.json",
                        "trb check " + arguments.words[0] + " says what is wrong there"));
  }
  const auto trust = read_robot_trust(config);
  if (!trust) return print_error(arguments, trust.error());
  const auto shown = look_at_certificate(config.robot.host, *config.commands.port, trust->value_or(TlsTrust{}));
  if (!shown) return print_error(arguments, shown.error());
  arguments.has("--json") ? print_json(certificate_json(*shown)) : print_certificate(*shown);
  return shown->refused ? kFailed : kGood;
}

const std::vector<Command> kRobotCertificateCommands = {
    {{"robot", "certificate"},
     {"robot certificate NODE_DIR",
      "Shows the certificate of the node's robot, whether the node takes it, and what to write into commands.json.\n"
      "It asks the robot for nothing but a handshake of TLS.",
      {kJson},
      {"trb robot certificate nodes/abb1"},
      1,
      1},
     run_robot_certificate}};

}  // namespace

std::vector<Command> robot_certificate_commands() {
  return kRobotCertificateCommands;
}

}  // namespace trb::cli
