// audit verify: what people did at a cloud's gateway, proven to a third party who has the fleet's public key alone.
#include "common/audit/audit_export.hpp"
#include "common/base/files.hpp"
#include "services/cli/commands/authority_words.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMaxAuditFile = 256U << 20U;  ///< some 600,000 records

Value count_value(std::uint64_t value) {
  return Value{static_cast<std::int64_t>(value)};
}

void print_report_json(const AuditCheck& check) {
  Value::Object out{{"node", Value{check.node}},
                    {"records", count_value(check.records)},
                    {"good", count_value(check.report.good)},
                    {"covered", count_value(check.report.covered)},
                    {"heads", count_value(check.heads)},
                    {"other_heads", count_value(check.other_heads)}};
  if (check.report.fault) {
    const AuditFault& fault = *check.report.fault;
    out.emplace_back("fault", Value{Value::Object{{"kind", Value{std::string(name_of(fault.kind))}},
                                                  {"number", count_value(fault.number)},
                                                  {"what", Value{fault.what}}}});
  }
  print_json(Value{std::move(out)});
}

void print_report(const AuditCheck& check) {
  const AuditReport& report = check.report;
  print_line("audit log of " + check.node + ": " + std::to_string(check.records) + " records, " +
             std::to_string(check.heads) + " signed heads");
  if (report.fault) {
    print_line(coloured(Colour::bad, "FAULT " + std::string(name_of(report.fault->kind)) + ", record " +
                                         std::to_string(report.fault->number) + ": " + report.fault->what));
  }
  print_line("proven: records 1 to " + std::to_string(report.covered) + ", which a signed head covers");
  if (report.good > report.covered) {
    print_line("fit the chain, but no signed head covers them yet: " + std::to_string(report.covered + 1) + " to " +
               std::to_string(report.good));
  }
  if (check.other_heads > 0) {
    print_line(std::to_string(check.other_heads) +
               " heads are not signed with the key in the node's certificate (an older key?): they prove nothing");
  }
}

/// The files' lines, in the order of the names.
Result<std::string> text_of(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) {
    const auto file = read_file(name, kMaxAuditFile - out.size());
    if (!file) return fail(file.error().code, file.error().what, "name the files that the gateway exported");
    out += *file;
    if (!out.ends_with('\n') && out.size() < kMaxAuditFile) out += '\n';
  }
  return out;
}

int run_verify(const Arguments& arguments) {
  init_crypto();
  const auto authority = authority_of(arguments);
  if (!authority) return print_error(arguments, authority.error());
  const auto text = text_of(arguments.words);
  if (!text) return print_error(arguments, text.error());
  const auto check = check_audit_export(*text, *authority);
  if (!check) return print_error(arguments, check.error());
  arguments.has("--json") ? print_report_json(*check) : print_report(*check);
  return check->report.fault ? kFailed : kGood;
}

const std::vector<Command> kAuditCommands = {
    {{"audit", "verify"},
     {"audit verify FILE ...",
      "Checks an exported audit log of a cloud's gateway: no record is changed, missing or inserted, and which of "
      "them\n"
      "the node's signed heads prove. FILE is what GET /api/v1/audit/export gave (several pages in their order).\n"
      "Exit status 0: all records fit; 1: one does not, and it says which.",
      {"--fleet FLEET_DIR|the fleet's public half, fleet.json", "--key HEX|the authority's public key instead", kJson},
      {"trb audit verify audit.jsonl --fleet ~/hall-3-authority"},
      1,
      1000},
     run_verify},
};

}  // namespace

std::vector<Command> audit_commands() {
  return kAuditCommands;
}

}  // namespace trb::cli
