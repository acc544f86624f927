// The proof log: what came by a node's links, kept with its seals, and what a third party can tell from it with the
// fleet's public key alone. Pure; the format is in proto/README.md, "The proof log".
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/security/seal.hpp"
#include "proto/message.hpp"

namespace trb {

/// A link, from the side that keeps the log; at its beginning, or where a file takes it up.
struct ProofLink {
  std::uint64_t link = 0;
  bool dialled = false;     ///< by the side that keeps the log
  std::uint64_t first = 1;  ///< sequence of the next frame
  Bytes previous = first_previous();
  SignedRecord own;   ///< certificates, as the two Hellos carried them
  SignedRecord peer;  ///< of the side that seals
};

Bytes proof_head();
void append_proof_link(Bytes& out, const ProofLink& link);
void append_proof_frame(Bytes& out, std::uint64_t link, UtcTime heard, BytesView frame);
void append_proof_end(Bytes& out, std::uint64_t link, UtcTime at, std::string_view why);
/// Fills in the checks of the records from this offset on, which append_proof_*() leaves out: whoever gathers records
/// has no time for them, whoever writes them has.
void finish_proof_records(Bytes& records, std::size_t from);

/// How many bytes of a log's file lie before a record at its end that was only begun. All of them, if there is none, or
/// if the file was damaged in another way: what somebody has changed stays to be seen.
std::size_t whole_proof_records(BytesView file);

enum class ProofState : std::uint8_t {
  proven,         ///< sealed by its sender
  authenticated,  ///< the link's encryption proved it to the keeper of the log; no seal came after it
  broken,         ///< its seal, or what lies around it, is not what it was
};
constexpr auto enum_names(ProofState) {
  return std::array<std::string_view, 3>{"proven", "authenticated", "broken"};
}

struct ProvenMessage {
  std::string file;
  std::size_t record = 0;  ///< in the file, from 1
  ProofState state{};
  std::string by;  ///< the node whose seal proves it, or whose link it came by
  UtcTime heard;   ///< says the keeper of the log
  UtcTime sealed;  ///< says the sender; 0 if not proven
  std::uint64_t link = 0;
  std::uint64_t sequence = 0;
  Message message;
};

struct ProofFault {
  std::string file;
  std::size_t record = 0;  ///< 0: the file itself
  std::size_t offset = 0;  ///< of the record, in bytes
  std::string what;
};

/// Messages that were sent and are not in the log.
struct ProofGap {
  std::string file;
  std::size_t record = 0;
  std::string by;
  std::uint64_t link = 0;
  std::uint64_t first = 0;  ///< sequences, seals among them
  std::uint64_t last = 0;
};

struct ProofReport {
  std::vector<ProvenMessage> messages;
  std::vector<ProofFault> faults;
  std::size_t seals = 0;                      ///< good ones
  std::map<std::string, std::size_t> proven;  ///< messages by node
  std::vector<ProofGap> gaps;
};

/// Reads the files of one log in the order of their names; each can be read alone.
class ProofChecker {
 public:
  explicit ProofChecker(FleetAuthority authority) : authority_(std::move(authority)) {}
  void read(const std::string& name, BytesView file);
  [[nodiscard]] const ProofReport& report() const { return report_; }

 private:
  struct OpenLink {
    SealScope scope;
    Certificate peer;
    SealReader reader;
    std::vector<std::size_t> open;  ///< messages (by index) that wait for their seal
  };
  struct Place {
    std::string file;
    std::size_t record = 0;
    std::size_t offset = 0;
  };
  void read_record(const Place& at, std::uint8_t kind, BytesView payload);
  void open_link(const Place& at, BytesView payload);
  void take_frame(const Place& at, BytesView payload);
  void take_seal(const Place& at, OpenLink& link, const HeaderView& header);
  /// A link's sequence goes on where it was, through all files.
  void go_on(const Place& at, std::uint64_t link, std::uint64_t first, const std::string& peer);
  /// Of messages, by their numbers in the report.
  void mark(const std::vector<std::size_t>& messages, ProofState state, UtcTime sealed);
  [[nodiscard]] std::string records_text(const std::vector<std::size_t>& messages) const;
  void cut_off(const Place& at, std::size_t bytes);
  void fault(const Place& at, std::string what);

  FleetAuthority authority_;
  std::map<std::uint64_t, OpenLink> links_;          ///< of the file that is read
  std::map<std::uint64_t, std::uint64_t> expected_;  ///< link -> what must come next, through all files
  ProofReport report_;
};

}  // namespace trb
