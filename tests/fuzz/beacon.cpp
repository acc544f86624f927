// Datagrams on the beacons' port: as they come, as if the sender had the fleet's beacon key, as if a member had signed.
#include "common/security/beacon_key.hpp"
#include "tests/fuzz/router_under_test.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::router;

const BeaconKey kKey{1, Bytes(32, 'k')};

/// Receives the beacon twice, with a tick after it.
void hear(BytesView plain) {
  RouterCore core = make_router();
  Effects effects;
  core.start(kNow, effects);
  core.beacons().on_beacon(plain, kNow, effects);
  core.beacons().on_beacon(plain, kNow, effects);
  core.tick({kNow.mono + std::chrono::seconds(3), kNow.utc + std::chrono::seconds(3)}, effects);
  check_table(core);
}

Bytes beacon_of(const TestKeys& keys, const Beacon& beacon) {
  return encode(
      sign(kSignedBeacon, keys.certificate.id, Keys::get().authority.fleet.id(), encode(beacon), keys.identity));
}

}  // namespace

std::vector<Bytes> seeds() {
  const Keys& keys = Keys::get();
  const Beacon bee{keys.bee.record, "10.0.0.2:45000", 1, kStartUtc, 1};
  const Beacon cat{keys.cat.record, "[fd00::2]:45000", 2, kStartUtc, 9};
  return {encode(bee), encode(cat), beacon_of(keys.bee, bee),
          seal_beacon(kKey, keys.authority.fleet.id(), beacon_of(keys.bee, bee))};
}

void run(BytesView input) {
  const Keys& keys = Keys::get();
  if (const auto plain = open_beacon(kKey, keys.authority.fleet.id(), input)) hear(*plain);
  hear(input);
  if (const auto beacon = decode<Beacon>(input)) hear(beacon_of(keys.bee, *beacon));
}

}  // namespace trb::fuzz
