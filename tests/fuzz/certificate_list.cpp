// Certificates and revocation lists: as they come, and as if the authority had signed them.
#include "common/security/certificate_file.hpp"
#include "common/security/revocations.hpp"
#include "tests/fuzz/router_under_test.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::router;

RevocationList make_list(std::uint64_t number, const std::vector<Revocation>& revoked) {
  const Keys& keys = Keys::get();
  return {{keys.authority.fleet.id()}, number, kStartUtc, revoked, 2, {{"ant", {Bytes(80, 'b')}}}};
}

void as_it_comes(BytesView input) {
  const FleetAuthority& fleet = Keys::get().authority.fleet;
  if (const auto record = decode<SignedRecord>(input)) {
    if (open_certificate(*record, fleet, kNow.utc))
      require(record->payload.bytes == Keys::get().bee.record.payload.bytes ||
                  record->payload.bytes == Keys::get().cat.record.payload.bytes,
              "only what the authority has signed is a certificate");
    if (const auto list = open_revocations(*record, fleet))
      require(list->fleet.bytes == fleet.id(), "only this fleet's list is opened");
  }
  if (const auto update = decode<TrustUpdate>(input)) {
    RouterCore core = make_router();
    Effects effects;
    (void)core.updates().on_update(*update, 0, kNow, effects);
    check_table(core);
  }
  if (const auto update = from_json<TrustUpdate>(input)) {
    require(from_json<TrustUpdate>(to_json(*update)).ok(), "the JSON of news can be read again");
  }
  (void)certificate_file_from_json(input);
}

/// The authority may sign anything: a mistake of it must not crash a node.
void as_if_signed(BytesView input) {
  const Keys& keys = Keys::get();
  const Bytes payload(input);
  const SignedRecord list = keys.sign_as_authority(kSignedRevocations, payload);
  const SignedRecord certificate = keys.sign_as_authority(kSignedCertificate, payload);
  if (const auto opened = open_revocations(list, keys.authority.fleet)) {
    for (const TestKeys* node : {&keys.ant, &keys.bee, &keys.cat}) {
      (void)find_revocation(*opened, node->certificate);
      (void)open_listed_beacon_key(*opened, node->certificate.id, node->link);
    }
  }
  RouterCore core = make_router();
  Effects effects;
  const Message hello = make_message(MessageType::information, "bee", "ant", make_hello(keys.bee, "bee"));
  core.inbox().on_message(7, keys.bee.link.public_key, hello, 1, kNow, effects);
  (void)core.updates().on_update({list, {certificate}}, 7, kNow, effects);
  (void)core.updates().on_update({list, {certificate}}, 7, kNow, effects);
  core.tick({kNow.mono + std::chrono::seconds(3), kNow.utc + std::chrono::seconds(3)}, effects);
  check_table(core);
}

}  // namespace

std::vector<Bytes> seeds() {
  const Keys& keys = Keys::get();
  const RevocationList empty = make_list(1, {});
  const RevocationList bee_is_out = make_list(2, {{1, "bee", "stolen", kStartUtc}});
  const RevocationList ant_is_out = make_list(3, {{1, "bee", "stolen", kStartUtc}, {1, "ant", "", kStartUtc}});
  Certificate renewed = keys.bee.certificate;
  renewed.serial = 5;
  Certificate own = keys.ant.certificate;
  own.serial = 6;
  const TrustUpdate update{keys.sign_as_authority(kSignedRevocations, encode(bee_is_out)), {keys.cat.record}};
  const CertificateFile file = make_certificate_file(keys.bee.record, keys.authority.fleet, {1, Bytes(32, 'k')},
                                                     keys.bee.certificate.link_key.bytes);
  return {encode(keys.bee.record), encode(keys.bee.certificate),
          encode(renewed),         encode(own),
          encode(empty),           encode(bee_is_out),
          encode(ant_is_out),      encode(update),
          to_json(update),         certificate_file_to_json(file)};
}

void run(BytesView input) {
  as_it_comes(input);
  as_if_signed(input);
}

}  // namespace trb::fuzz
