// The proof log: what a node received on its links, kept with its seals, and what a third party can verify from it with
// only the fleet's public key. Pure; the format is in proto/README.md, "The proof log".
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/security/seal.hpp"
#include "proto/message.hpp"

namespace trb {

/// A link, as seen by the side that keeps the log; at its beginning, or where a file continues it.
struct ProofLink {
  std::uint64_t link = 0;
  bool dialled = false;     ///< true if the keeper of the log dialled
  std::uint64_t first = 1;  ///< sequence of the next frame
  Bytes previous = first_previous();
  SignedRecord own;   ///< certificates, as the two Hellos carried them
  SignedRecord peer;  ///< the certificate of the side that seals
};

Bytes proof_head();
void append_proof_link(Bytes& out, const ProofLink& link);
void append_proof_frame(Bytes& out, std::uint64_t link, UtcTime heard, BytesView frame);
void append_proof_end(Bytes& out, std::uint64_t link, UtcTime at, std::string_view why);
/// Fills in the checks of the records from this offset on, which append_proof_*() leaves out: the thread that collects
/// records has no time for them, the one that writes them has.
void finish_proof_records(Bytes& records, std::size_t from);

/// The number of bytes of a log's file before an incomplete record at its end. All of them, if there is none, or if the
/// file is damaged in another way: tampering must stay visible.
std::size_t whole_proof_records(BytesView file);

enum class ProofState : std::uint8_t {
  proven,         ///< sealed by its sender
  authenticated,  ///< the link's encryption proved it to the keeper of the log; no seal followed
  broken,         ///< its seal, or a record around it, was changed
};
constexpr auto enum_names(ProofState) {
  return std::array<std::string_view, 3>{"proven", "authenticated", "broken"};
}

struct ProvenMessage {
  std::string file;
  std::size_t record = 0;  ///< in the file, from 1
  ProofState state{};
  std::string by;  ///< the node whose seal proves it, or on whose link it came
  UtcTime heard;   ///< according to the keeper of the log
  UtcTime sealed;  ///< according to the sender; 0 if not proven
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

/// Messages that were sent but are not in the log.
struct ProofGap {
  std::string file;
  std::size_t record = 0;
  std::string by;
  std::uint64_t link = 0;
  std::uint64_t first = 0;  ///< sequences, including seals
  std::uint64_t last = 0;
};

struct ProofReport {
  std::vector<ProvenMessage> messages;
  std::vector<ProofFault> faults;
  std::size_t seals = 0;                      ///< valid ones
  std::map<std::string, std::size_t> proven;  ///< messages by node
  std::vector<ProofGap> gaps;
};

/// Reads the files of one log in the order of their names; each file can also be read alone.
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
  /// Checks that a link's sequence continues where it ended, across all files.
  void go_on(const Place& at, std::uint64_t link, std::uint64_t first, const std::string& peer);
  /// For messages, by their numbers in the report.
  void mark(const std::vector<std::size_t>& messages, ProofState state, UtcTime sealed);
  [[nodiscard]] std::string records_text(const std::vector<std::size_t>& messages) const;
  void cut_off(const Place& at, std::size_t bytes);
  void fault(const Place& at, std::string what);

  FleetAuthority authority_;
  std::map<std::uint64_t, OpenLink> links_;          ///< in the current file
  std::map<std::uint64_t, std::uint64_t> expected_;  ///< link -> the next expected sequence, across all files
  ProofReport report_;
};

}  // namespace trb
