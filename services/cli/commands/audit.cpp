// audit verify: what people did at a cloud's gateway, proven to a third party who has the fleet's public key alone.
#include <algorithm>
#include <optional>
#include <utility>

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

Value report_json(const AuditCheck& check) {
  Value::Object out{{"node", Value{check.node}},
                    {"records", count_value(check.records)},
                    {"good", count_value(check.report.good)},
                    {"covered", count_value(check.report.covered)},
                    {"heads", count_value(check.heads)},
                    {"other_heads", count_value(check.other_heads)}};
  Value::List restored;
  for (const AuditRecord& one : check.report.restored) restored.push_back(count_value(one.number));
  out.emplace_back("restored", Value{std::move(restored)});
  if (check.report.fault) {
    const AuditFault& fault = *check.report.fault;
    out.emplace_back("fault", Value{Value::Object{{"kind", Value{std::string(name_of(fault.kind))}},
                                                  {"number", count_value(fault.number)},
                                                  {"what", Value{fault.what}}}});
  }
  return Value{std::move(out)};
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
  for (const AuditRecord& one : report.restored) {
    print_line("record " + std::to_string(one.number) + ", " + to_iso8601({one.time}) + ": restored " + one.about +
               "; what people did between that time and this record is lost, but in an earlier export");
  }
  if (check.other_heads > 0) {
    print_line(std::to_string(check.other_heads) +
               " heads are not signed with the key in the node's certificate (an older key?): they prove nothing");
  }
}

/// In the order of the names.
Result<std::vector<std::string>> texts_of(const std::vector<std::string>& names) {
  std::vector<std::string> out;
  std::size_t all = 0;
  for (const std::string& name : names) {
    auto file = read_file(name, kMaxAuditFile - all);
    if (!file) return fail(file.error().code, file.error().what, "name the files that the gateway exported");
    all += file->size();
    out.push_back(std::move(*file));
  }
  return out;
}

struct Checked {
  std::vector<AuditCheck> logs;
  std::vector<std::optional<AuditParting>> partings;  ///< of each log but the first from the one before
  [[nodiscard]] bool is_good() const {
    return std::ranges::none_of(logs, [](const AuditCheck& one) { return one.report.fault.has_value(); }) &&
           std::ranges::none_of(partings, [](const auto& one) { return one.has_value(); });
  }
};

Result<Checked> check_logs(const std::vector<std::string>& logs, const FleetAuthority& authority) {
  Checked out;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    auto check = check_audit_export(logs[i], authority);
    if (!check) return check.error();
    out.logs.push_back(std::move(*check));
    if (i == 0) continue;
    auto parting = find_parting(logs[i - 1], logs[i]);
    if (!parting) return parting.error();
    out.partings.push_back(std::move(*parting));
  }
  return out;
}

std::string words_of(const AuditRecord& record) {
  return "record " + std::to_string(record.number) + ", " + to_iso8601({record.time}) + ", " + record.who + ": " +
         record.action + " " + record.about;
}

void print_parting(const std::optional<AuditParting>& parting, std::size_t second) {
  const std::string logs = "logs " + std::to_string(second - 1) + " and " + std::to_string(second);
  if (!parting) return print_line(logs + ": one goes on where the other one ends");
  print_line(coloured(Colour::bad, logs + " PART after record " + std::to_string(parting->alike)));
  for (const auto& [number, next] : {std::pair(second - 1, parting->first), std::pair(second, parting->second)})
    print_line("  log " + std::to_string(number) + " goes on with " + words_of(*next));
}

void print_checked(const Checked& checked) {
  for (std::size_t i = 0; i < checked.logs.size(); ++i) {
    if (checked.logs.size() > 1) print_line("log " + std::to_string(i + 1) + ":");
    print_report(checked.logs[i]);
    if (i > 0) print_parting(checked.partings[i - 1], i + 1);
  }
}

void print_checked_json(const Checked& checked) {
  if (checked.logs.size() == 1) return print_json(report_json(checked.logs[0]));
  Value::List logs;
  for (const AuditCheck& one : checked.logs) logs.push_back(report_json(one));
  Value::List parts;
  for (const auto& one : checked.partings) parts.push_back(one ? count_value(one->alike) : Value{});
  print_json(Value{Value::Object{{"logs", Value{std::move(logs)}}, {"part_after", Value{std::move(parts)}}}});
}

int run_verify(const Arguments& arguments) {
  init_crypto();
  const auto authority = authority_of(arguments);
  if (!authority) return print_error(arguments, authority.error());
  const auto texts = texts_of(arguments.words);
  if (!texts) return print_error(arguments, texts.error());
  const auto logs = join_exports(*texts);
  if (!logs) return print_error(arguments, logs.error());
  const auto checked = check_logs(*logs, *authority);
  if (!checked) return print_error(arguments, checked.error());
  arguments.has("--json") ? print_checked_json(*checked) : print_checked(*checked);
  return checked->is_good() ? kGood : kFailed;
}

const std::vector<Command> kAuditCommands = {
    {{"audit", "verify"},
     {"audit verify FILE ...",
      "Checks an exported audit log of a cloud's gateway: no record is changed, missing or inserted, and which of "
      "them\n"
      "the node's signed heads prove. FILE is what GET /api/v1/audit/export gave (several pages in their order).\n"
      "Of two exports of one log, made at different times, it tells where they part: after a backup was brought back.\n"
      "Exit status 0: all records fit; 1: one does not, or two logs part, and it says which.",
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
