// The news of the authority on disk: state/news, state/utc, keys/certificate.json, keys/news.json.
#include <filesystem>

#include "common/base/files.hpp"
#include "common/security/certificate_file.hpp"
#include "common/security/revocations.hpp"
#include "proto/body.hpp"
#include "services/router/io/router_shell.hpp"

namespace trb::router {
namespace {

/// By its whole path, and with what to do.
Status in_full(const Status& done, const std::string& path) {
  if (done) return done;
  const std::string whole = std::filesystem::absolute(path).string();
  return fail(done.error().code, done.error().what,
              "make room for " + whole + " (df -h " + whole + "), or let it be written to");
}

Status store_news_file(const FleetNews& news) {
  const Bytes bytes = encode(news);
  // At each start it is taken from there, and is there.
  if (const auto there = read_file("state/news"); there && *there == bytes) return Done{};
  return write_file("state/news", bytes);
}

Status store_certificate_file(const std::string& path, const SignedRecord& record) {
  auto file = read_certificate_file(path);
  if (!file) return file.error();
  if (file->certificate == record) return Done{};
  file->certificate = record;
  return write_file(path, certificate_file_to_json(*file));
}

}  // namespace

/// The number is as long in every start: a full disk has room for it where it stands.
Status write_boot(std::uint64_t boot) {
  const std::string digits = std::to_string(boot);
  const std::string text = std::string(20 - digits.size(), '0') + digits + "\n";
  const Status whole = write_file(kBootFile, text);
  if (whole || overwrite_file(kBootFile, text)) return Done{};
  return in_full(whole, "state");
}

void RouterShell::store_news(const StoreNews& store) {
  stored(Kept::news, in_full(store_news_file(store.news), "state"));
  if (store.beacon_box.empty() || store.beacon_number <= options_.beacon_key.number) return;
  const LinkKey own{options_.link_keys.public_key, options_.link_keys.secret_key};
  auto key = open_sealed_beacon_key(store.beacon_number, store.beacon_box, own);
  if (!key) return log_event(Level::error, "no_beacon_key", key.error().text());
  options_.beacon_key = std::move(*key);
  log_event(Level::info, "beacon_key", "number " + std::to_string(store.beacon_number) + " from now on");
}

void RouterShell::store_certificate(const StoreCertificate& store) {
  const std::string path = "keys/certificate.json";
  stored(Kept::certificate, in_full(store_certificate_file(path, store.record), "keys"));
}

void RouterShell::store_boot(const StoreBoot& store) {
  stored(Kept::boot, write_boot(store.boot));
}

void RouterShell::stored(Kept what, const Status& done) {
  Effects effects;
  core_.updates().on_stored(what, done, read_clocks(), effects);
  carry_out(effects);
}

void RouterShell::store_utc(const StoreUtc& store) {
  // A lower bound alone: the one before it is as true.
  const Status done = write_file("state/utc", std::to_string(store.utc.ns) + "\n");
  if (!done) log_event(Level::warning, "not_stored", done.error().text());
}

void RouterShell::read_key_folder() {
  const auto take = [this](const FleetNews& news) {
    Effects effects;
    core_.updates().on_file(news, read_clocks(), effects);
    carry_out(effects);
  };
  if (auto file = read_certificate_file("keys/certificate.json")) take({file->revocations, {file->certificate}});
  if (!file_exists("keys/news.json")) return;
  auto news = read_trust_updates("keys/news.json");
  if (news) return take(*news);
  core_.counters().count("refused." + std::string(errc_name(news.error().code)));
  log_limited(limit_, read_clocks().mono, Level::warning, "news_refused", news.error().text());
}

}  // namespace trb::router
