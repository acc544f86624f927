// A proof log that a test writes record by record, and a third party's reading of it.
#pragma once

#include <doctest/doctest.h>

#include <string>
#include <utility>

#include "common/security/proof.hpp"
#include "proto/body.hpp"

namespace trb::test {

constexpr UtcTime kUtc{1'772'366'400'000'000'000};

struct Node {
  std::string id;
  SigningKey identity = make_signing_key();
  SignedRecord record;

  Node(std::string name, const FleetAuthority& fleet, const SigningKey& authority) : id(std::move(name)) {
    const Certificate certificate{{fleet.id()},
                                  7,
                                  id,
                                  Role::robot,
                                  {identity.public_key},
                                  {make_link_key().public_key},
                                  kUtc.ns - 1000,
                                  kUtc.ns + 1'000'000'000'000};
    record = sign(kSignedCertificate, "", fleet.id(), encode(certificate), authority);
  }
};

/// bee keeps what ant, the dialler, sends on link 5.
struct Log {
  SigningKey key = make_signing_key();
  FleetAuthority fleet{"hall", key.public_key};
  Node ant{"ant", fleet, key};
  Node bee{"bee", fleet, key};
  SealScope scope{5, 7, 7, true};
  SealWriter writer;
  Bytes file = proof_head();

  Log() { append_proof_link(file, {5, false, 1, first_previous(), bee.record, ant.record}); }

  Bytes frame(const std::string& subtype, const Bytes& data) {
    Message message;
    message.type = MessageType::information;
    message.subtype = subtype;
    message.source = "ant";
    message.target = "bee";
    message.id = writer.next();
    message.data = data;
    Bytes out = encode_frame(message);
    stamp_link(out.data(), 5, writer.next(), message.remaining_ms);
    return out;
  }
  void say(const Bytes& data) {
    const Bytes bytes = frame("note", data);
    writer.add(bytes);
    append_proof_frame(file, 5, kUtc, bytes);
  }
  void seal(UtcTime utc = kUtc) {
    const SignedRecord record = sign_seal(writer.range(scope, utc), "ant", fleet.id(), ant.identity);
    append_proof_frame(file, 5, kUtc, frame("seal", encode(Seal{record})));
    writer.sealed(record.payload.bytes);
  }
  /// A record as a later version, or an attacker, might write it.
  void add_record(char kind, const Bytes& payload) {
    for (const unsigned shift : {24U, 16U, 8U, 0U}) file += static_cast<char>(payload.size() >> shift);
    file += kind + Bytes(11, '\0') + payload;
  }
  /// The fault of the only record that has one.
  std::string fault() const {
    const ProofReport report = read();
    REQUIRE(report.faults.size() == 1);
    return report.faults[0].what;
  }
  Bytes written() const {
    Bytes out = file;
    finish_proof_records(out, proof_head().size());
    return out;
  }
  ProofReport read(const Bytes& bytes) const {
    ProofChecker checker({"", fleet.public_key});
    checker.read("file", bytes);
    return checker.report();
  }
  ProofReport read() const { return read(written()); }
};

}  // namespace trb::test
