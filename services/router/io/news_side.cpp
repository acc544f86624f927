// The news of the authority on disk: state/news, state/utc, keys/certificate.json, keys/news.json.
#include "common/base/files.hpp"
#include "common/security/certificate_file.hpp"
#include "common/security/revocations.hpp"
#include "proto/body.hpp"
#include "services/router/io/router_shell.hpp"

namespace trb::router {
namespace {

void log_failure(const Status& done) {
  // It is in force all the same; a later start asks the other nodes again.
  if (!done) log_event(Level::error, "not_stored", done.error().text());
}

}  // namespace

void RouterShell::store_news(const StoreNews& store) {
  log_failure(write_file("state/news", encode(store.news), 0600));
  if (store.beacon_box.empty() || store.beacon_number <= options_.beacon_key.number) return;
  const LinkKey own{options_.link_keys.public_key, options_.link_keys.secret_key};
  auto key = open_sealed_beacon_key(store.beacon_number, store.beacon_box, own);
  if (!key) return log_event(Level::error, "no_beacon_key", key.error().text());
  options_.beacon_key = std::move(*key);
  log_event(Level::info, "beacon_key", "number " + std::to_string(store.beacon_number) + " from now on");
}

void RouterShell::store_certificate(const StoreCertificate& store) {
  const std::string path = "keys/certificate.json";
  auto file = read_certificate_file(path);
  if (!file) return log_event(Level::error, "not_stored", file.error().text());
  file->certificate = store.record;
  log_failure(write_file(path, certificate_file_to_json(*file)));
}

void RouterShell::store_utc(const StoreUtc& store) {
  log_failure(write_file("state/utc", std::to_string(store.utc.ns) + "\n"));
}

void RouterShell::read_key_folder() {
  const auto take = [this](const FleetNews& news) {
    Effects effects;
    core_.on_news_of_file(news, read_clocks(), effects);
    carry_out(effects);
  };
  if (auto file = read_certificate_file("keys/certificate.json")) take({file->revocations, {file->certificate}});
  if (!file_exists("keys/news.json")) return;
  auto news = read_news("keys/news.json");
  if (news) return take(*news);
  core_.count("refused." + std::string(errc_name(news.error().code)));
  log_limited(limit_, read_clocks().mono, Level::warning, "news_refused", news.error().text());
}

}  // namespace trb::router
