#include "common/config/robot_tls.hpp"

#include "common/base/files.hpp"
#include "common/base/fingerprint.hpp"

namespace trb {
namespace {

constexpr std::size_t kMostKeys = 8;
constexpr std::size_t kMaxFile = 256U << 10U;
constexpr const char* kPin =
    "write the fingerprint (SHA-256) of the robot's own certificate: trb robot certificate NODE_DIR shows it; compare "
    "it with the robot's own page first";

void read_fingerprint_key(ObjectReader& tls, VendorCommands& into) {
  const auto text = tls.text("fingerprint", Need::optional);
  if (!text) return;
  const auto fingerprint = read_fingerprint(*text);
  if (!fingerprint) return tls.faults().add(tls.path("fingerprint"), "is no SHA-256 in hexadecimal", kPin);
  into.texts["tls.fingerprint"] = {*fingerprint};
}

std::string text_of(const VendorCommands& vendor, const std::string& key) {
  const auto at = vendor.texts.find(key);
  return at == vendor.texts.end() ? std::string() : at->second.front();
}

/// Relative to the node's folder. Its errors do not name the file.
Result<std::string> read_authority(const std::string& path) {
  auto text = read_file(path, kMaxFile);
  if (!text)
    return fail(Errc::io_error, "cannot be read", "put the certificate of the robot's authority there, in PEM");
  if (text->find("-----BEGIN CERTIFICATE-----") != std::string::npos) return text;
  return fail(Errc::malformed, "has no certificate in PEM", "put it there: -----BEGIN CERTIFICATE----- ...");
}

std::string path_of(const NodeConfig& config) {
  const std::string file = text_of(config.commands, "tls.authority");
  return file.starts_with('/') ? file : config.dir + "/" + file;
}

}  // namespace

void read_tls_key(ObjectReader& vendor, VendorCommands& into) {
  const auto* members = vendor.object("tls", Need::optional, kMostKeys);
  if (members == nullptr) return;
  const Value json{*members};
  ObjectReader tls(json, vendor.path("tls"), vendor.faults());
  const std::size_t before = vendor.faults().count();
  read_fingerprint_key(tls, into);
  for (const char* key : {"authority", "name"}) {
    if (const auto text = tls.text(key, Need::optional)) into.texts[std::string("tls.") + key] = {*text};
  }
  tls.refuse_unknown_keys();
  if (vendor.faults().count() != before) return;
  const bool pinned = into.texts.contains("tls.fingerprint");
  const bool vouched = into.texts.contains("tls.authority");
  if (!pinned && !vouched)
    vendor.faults().add(vendor.path("tls"), "says of no certificate that it is the robot's", kPin);
  if (pinned && vouched)
    vendor.faults().add(tls.path("authority"), "stands beside a fingerprint",
                        "remove one of them: the fingerprint says all");
  if (pinned && into.texts.contains("tls.name"))
    vendor.faults().add(tls.path("name"), "stands beside a fingerprint, which says all", "remove it");
}

Result<std::optional<TlsTrust>> read_robot_trust(const NodeConfig& config) {
  TlsTrust trust{text_of(config.commands, "tls.fingerprint"), "", ""};
  if (!trust.fingerprint.empty()) return std::optional(trust);
  if (!config.commands.texts.contains("tls.authority")) return std::optional<TlsTrust>();
  auto authority = read_authority(path_of(config));
  if (!authority) {
    const Error& why = authority.error();
    return fail(why.code, path_of(config) + ": " + why.what, why.hint);
  }
  const std::string name = text_of(config.commands, "tls.name");
  return std::optional(TlsTrust{"", std::move(*authority), name.empty() ? config.robot.host : name});
}

void check_robot_trust(const NodeConfig& config, ConfigFaults& faults) {
  if (!config.commands.texts.contains("tls.authority")) return;
  const auto authority = read_authority(path_of(config));
  if (authority) return;
  const std::string file = text_of(config.commands, "tls.authority");
  FileFaults("commands.json", faults)
      .add(config.framework + ".tls.authority", file + " " + authority.error().what, authority.error().hint);
}

}  // namespace trb
