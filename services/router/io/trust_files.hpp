// What the authority has signed, on disk: state/news with its copy, state/dropped, state/utc, state/boot, state/peers,
// keys/certificate.json, keys/news.json.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/security/node_keys.hpp"
#include "services/router/io/beacon_channel.hpp"
#include "services/router/io/keys_watch.hpp"
#include "services/router/io/shell_context.hpp"

namespace trb::router {

constexpr const char* kBootFile = "state/boot";
/// Errors: io_error, with a cure.
Status write_boot(std::uint64_t boot);

/// Writes what the core orders into the node's folder, and reports to the core whether it is on disk; reads what a
/// person puts into keys/.
class TrustFiles {
 public:
  /// `own` decrypts the beacon keys that a trust update brings.
  TrustFiles(ShellContext& shell, BeaconChannel& beacons, LinkKey own);

  /// The core gets the outcome of these three.
  void store(const StoreUpdate& store);
  void store(const StoreCertificate& store);
  void store(const StoreBoot& store);
  /// A failure of these two is only logged: what was stored before still holds.
  void store(const StoreUtc& store);
  static void store(const StorePeers& store);

  /// Reads keys/ now, and whenever a file in it is written, given other rights or removed: a person may have put a
  /// certificate or a trust update there.
  void watch_keys();

 private:
  void stored(Kept what, const Status& done);
  void take_beacon_key(const StoreUpdate& store);
  void read_keys();
  void take(const std::string& path, const std::function<Result<TrustUpdate>(const std::string&)>& read);

  ShellContext& shell_;
  BeaconChannel& beacons_;
  LinkKey own_;
  std::unique_ptr<KeysWatch> watch_;
};

}  // namespace trb::router
