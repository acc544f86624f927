#include "services/router/io/trust_files.hpp"

#include <filesystem>

#include "common/base/files.hpp"
#include "common/security/certificate_file.hpp"
#include "common/security/revocations.hpp"
#include "common/security/stored_updates.hpp"
#include "proto/body.hpp"

namespace trb::router {
namespace {

/// Adds the whole path, and a cure.
Status in_full(const Status& done, const std::string& path) {
  if (done) return done;
  const std::string whole = std::filesystem::absolute(path).string();
  return fail(done.error().code, done.error().what,
              "make room for " + whole + " (df -h " + whole + "), or let it be written to");
}

/// Adds a cure: a file that came with scp as another user may be closed to this one.
Result<TrustUpdate> readable(Result<TrustUpdate> read, const std::string& path) {
  if (read || read.error().code != Errc::io_error) return read;
  return fail(Errc::io_error, read.error().what,
              "let the node's user read it: chmod a+r " + std::filesystem::absolute(path).string());
}

Status store_certificate_file(const std::string& path, const SignedRecord& record) {
  auto file = read_certificate_file(path);
  if (!file) return file.error();
  if (file->certificate == record) return Done{};
  file->certificate = record;
  return write_file(path, certificate_file_to_json(*file));
}

}  // namespace

/// The number has the same length at every start: it can be written over in place on a full disk.
Status write_boot(std::uint64_t boot) {
  const std::string digits = std::to_string(boot);
  const std::string text = std::string(20 - digits.size(), '0') + digits + "\n";
  const Status whole = write_file(kBootFile, text);
  if (whole || overwrite_file(kBootFile, text)) return Done{};
  return in_full(whole, "state");
}

TrustFiles::TrustFiles(ShellContext& shell, BeaconChannel& beacons, LinkKey own)
    : shell_(shell), beacons_(beacons), own_(std::move(own)) {}

void TrustFiles::store(const StoreUpdate& store) {
  stored(Kept::update, in_full(write_stored_updates(".", store.update, store.dropped), "state"));
  if (!store.beacon_box.empty() && store.beacon_number > beacons_.key_number()) take_beacon_key(store);
}

void TrustFiles::take_beacon_key(const StoreUpdate& store) {
  auto key = open_sealed_beacon_key(store.beacon_number, store.beacon_box, own_);
  if (!key) return log_event(Level::error, "no_beacon_key", key.error().text());
  beacons_.set_key(std::move(*key));
  log_event(Level::info, "beacon_key", "number " + std::to_string(store.beacon_number) + " from now on");
}

void TrustFiles::store(const StoreCertificate& store) {
  const std::string path = "keys/certificate.json";
  stored(Kept::certificate, in_full(store_certificate_file(path, store.record), "keys"));
}

void TrustFiles::store(const StoreBoot& store) {
  stored(Kept::boot, write_boot(store.boot));
}

void TrustFiles::stored(Kept what, const Status& done) {
  Effects effects;
  shell_.core().updates().on_stored(what, done, read_clocks(), effects);
  shell_.carry_out(effects);
}

void TrustFiles::store(const StoreUtc& store) {
  const Status done = write_file("state/utc", std::to_string(store.utc.ns) + "\n");
  if (!done) log_event(Level::warning, "not_stored", done.error().text());
}

void TrustFiles::store(const StorePeers& store) {
  if (Status kept = write_file("state/peers", store.text, 0600); !kept)
    log_event(Level::warning, "state", kept.error().text());
}

void TrustFiles::watch_keys() {
  watch_ = std::make_unique<KeysWatch>(shell_.loop(), "keys", [this] { read_keys(); });
  read_keys();
}

void TrustFiles::read_keys() {
  take("keys/certificate.json", [](const std::string& path) -> Result<TrustUpdate> {
    auto file = read_certificate_file(path);
    if (!file) return file.error();
    return TrustUpdate{file->revocations, {file->certificate}};
  });
  take("keys/news.json", read_trust_updates);
}

void TrustFiles::take(const std::string& path, const std::function<Result<TrustUpdate>(const std::string&)>& read) {
  if (!file_exists(path)) return shell_.core().updates().on_gone(path);
  Effects effects;
  shell_.core().updates().on_brought(path, readable(read(path), path), read_clocks(), effects);
  shell_.carry_out(effects);
}

}  // namespace trb::router
