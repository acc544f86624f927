// proof: what a node's log proves to a third party who has the fleet's public key alone.
#include <algorithm>
#include <array>
#include <filesystem>
#include <map>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/security/proof.hpp"
#include "services/cli/commands/authority_words.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMaxProofFile = 128U << 20U;  ///< a router's are of 64 MiB at most
/// The files named, and those of the folders named, in the order of their names.
std::vector<std::string> files_of(const std::vector<std::string>& words) {
  std::vector<std::string> out;
  for (const std::string& word : words) {
    std::error_code none;
    std::string folder = word;
    if (std::filesystem::is_directory(word + "/log/proof", none)) folder = word + "/log/proof";
    if (!std::filesystem::is_directory(folder, none)) {
      out.push_back(word);
      continue;
    }
    std::vector<std::string> inside;
    for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
      if (entry.path().extension() == ".log") inside.push_back(entry.path().string());
    }
    std::sort(inside.begin(), inside.end());
    out.insert(out.end(), inside.begin(), inside.end());
  }
  return out;
}

std::string time_of(UtcTime time) {
  return time.ns == 0 ? "" : to_iso8601(time);
}

Value number(std::size_t value) {
  return Value{static_cast<std::int64_t>(value)};
}

Value to_value(const ProvenMessage& row) {
  return Value{Value::Object{{"file", Value{row.file}},
                             {"record", number(row.record)},
                             {"state", Value{std::string(name_of(row.state))}},
                             {"by", Value{row.by}},
                             {"heard", Value{time_of(row.heard)}},
                             {"sealed", Value{time_of(row.sealed)}},
                             {"link", Value{std::to_string(row.link)}},
                             {"sequence", number(row.sequence)},
                             {"source", Value{row.message.source}},
                             {"target", Value{row.message.target}},
                             {"type", Value{std::string(name_of(row.message.type))}},
                             {"subtype", Value{row.message.subtype}},
                             {"id", Value{std::to_string(row.message.id)}},
                             {"data_hex", Value{to_hex(row.message.data)}}}};
}

/// What came by one link behind its last seal.
struct Tail {
  std::uint64_t link = 0;
  std::string by;
  std::uint64_t first = 0;  ///< sequence
  std::size_t messages = 0;
};

struct Sums {
  using Nodes = std::map<std::string, std::array<std::size_t, 3>>;  ///< by ProofState
  using Node = Nodes::value_type;
  Nodes nodes;
  std::vector<Tail> tails;
};

Sums sums_of(const ProofReport& report) {
  Sums out;
  std::map<std::uint64_t, std::size_t> tails;
  for (const ProvenMessage& row : report.messages) {
    ++out.nodes[row.by][static_cast<std::size_t>(row.state)];
    if (row.state != ProofState::authenticated) continue;
    const auto [at, fresh] = tails.try_emplace(row.link, out.tails.size());
    if (fresh) out.tails.push_back({row.link, row.by, row.sequence, 0});
    ++out.tails[at->second].messages;
  }
  return out;
}

Value link_value(std::uint64_t link) {
  return Value{std::to_string(link)};
}

Value to_value(const ProofFault& row) {
  return Value{Value::Object{{"file", Value{row.file}},
                             {"record", number(row.record)},
                             {"offset", number(row.offset)},
                             {"what", Value{row.what}}}};
}

Value to_value(const ProofGap& row) {
  return Value{Value::Object{{"file", Value{row.file}},
                             {"record", number(row.record)},
                             {"by", Value{row.by}},
                             {"link", link_value(row.link)},
                             {"first", number(row.first)},
                             {"last", number(row.last)}}};
}

Value to_value(const Tail& row) {
  return Value{Value::Object{{"by", Value{row.by}},
                             {"link", link_value(row.link)},
                             {"first", number(row.first)},
                             {"messages", number(row.messages)}}};
}

Value to_value(const Sums::Node& row) {
  const auto& [node, counts] = row;
  return Value{Value::Object{{"by", Value{node}},
                             {"proven", number(counts[0])},
                             {"authenticated", number(counts[1])},
                             {"broken", number(counts[2])}}};
}

template <class Rows>
Value list_of(const Rows& rows) {
  Value::List out;
  for (const auto& row : rows) out.push_back(to_value(row));
  return Value{std::move(out)};
}

void print_report_json(const ProofReport& report) {
  const Sums sums = sums_of(report);
  print_json(Value{Value::Object{{"seals", number(report.seals)},
                                 {"nodes", list_of(sums.nodes)},
                                 {"tails", list_of(sums.tails)},
                                 {"gaps", list_of(report.gaps)},
                                 {"faults", list_of(report.faults)},
                                 {"messages", list_of(report.messages)}}});
}

/// A text that a stranger may have written, for a terminal.
std::string harmless(std::string text) {
  for (char& letter : text) {
    if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7f) letter = '?';
  }
  return text;
}

void print_messages(const ProofReport& report) {
  std::vector<std::vector<std::string>> rows{{"HEARD", "SOURCE", "TARGET", "TYPE", "SUBTYPE", "ID", "STATE", "BY"}};
  for (const ProvenMessage& row : report.messages) {
    rows.push_back({time_of(row.heard), harmless(row.message.source), harmless(row.message.target),
                    std::string(name_of(row.message.type)), row.message.subtype, std::to_string(row.message.id),
                    std::string(name_of(row.state)), row.by});
  }
  print(format_table(rows) + "\n");
}

void print_summary(const ProofReport& report) {
  const Sums sums = sums_of(report);
  std::vector<std::vector<std::string>> rows{{"BY", "PROVEN", "AUTHENTICATED", "BROKEN"}};
  for (const auto& [node, counts] : sums.nodes) {
    rows.push_back({node, std::to_string(counts[0]), std::to_string(counts[1]), std::to_string(counts[2])});
  }
  print(format_table(rows));
  print_line(std::to_string(report.seals) + " seals hold.");
  for (const Tail& row : sums.tails) {
    print_line("Authenticated only: " + std::to_string(row.messages) + " messages of " + row.by + ", link " +
               std::to_string(row.link) + " from sequence " + std::to_string(row.first) +
               " on: no seal came after them");
  }
  for (const ProofGap& row : report.gaps) {
    print_line("Not in the log: link " + std::to_string(row.link) + " of " + row.by + ", sequences " +
               std::to_string(row.first) + " to " + std::to_string(row.last) + " (before record " +
               std::to_string(row.record) + " of " + row.file + ")");
  }
  for (const ProofFault& row : report.faults) {
    print_line(coloured(Colour::bad, "FAULT " + row.file + ", record " + std::to_string(row.record) + " at byte " +
                                         std::to_string(row.offset) + ": " + row.what));
  }
}

int run_proof(const Arguments& arguments) {
  init_crypto();
  auto authority = authority_of(arguments);
  if (!authority) return print_error(arguments, authority.error());
  ProofChecker checker(std::move(*authority));
  const std::vector<std::string> files = files_of(arguments.words);
  if (files.empty())
    return print_error(arguments, fail(Errc::missing, "no proof log there", "name NODE_DIR/log/proof or a file of it"));
  for (const std::string& name : files) {
    auto file = read_file(name, kMaxProofFile);
    if (!file)
      return print_error(arguments,
                         fail(file.error().code, file.error().what, "name NODE_DIR/log/proof, or its files"));
    checker.read(name, *file);
  }
  const ProofReport& report = checker.report();
  if (arguments.has("--json")) {
    print_report_json(report);
  } else {
    if (!arguments.has("--summary")) print_messages(report);
    print_summary(report);
  }
  return report.faults.empty() ? kGood : kFailed;
}

const std::vector<Command> kProofCommands = {
    {{"proof"},
     {"proof LOG ...",
      "Shows which messages a node's log proves, and by whom, to anybody who has the fleet's public key.\n"
      "LOG is a file, a folder log/proof or a node's folder. Exit status 0: all is proven but for what came by a "
      "link\n"
      "behind its last seal; 1: something is not what it was, and it says in which file, record and byte. More:\n"
      "trb help proof.",
      {"--fleet FLEET_DIR|the fleet's public half, fleet.json", "--key HEX|the authority's public key instead",
       "--summary|no list of messages", kJson},
      {"trb proof nodes/ur3/log/proof --fleet ~/hall-3-authority",
       "trb proof proof-0000000007.log --key 5f0c... --summary"},
      1,
      1000},
     run_proof},
};

}  // namespace

std::vector<Command> proof_commands() {
  return kProofCommands;
}

}  // namespace trb::cli
