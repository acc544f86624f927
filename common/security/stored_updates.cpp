#include "common/security/stored_updates.hpp"

#include <filesystem>
#include <utility>

#include "common/base/files.hpp"
#include "common/security/revocations.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

/// The first is written first: if a crash comes between the two, it is the newer one.
constexpr const char* kFiles[] = {"state/news", "state/news.copy"};

std::string cure(const std::string& node_dir, const Error& why) {
  std::error_code none;
  const std::string dir = std::filesystem::weakly_canonical(node_dir, none).string();
  if (why.code == Errc::io_error)
    return "let the node's user read it: chown -R --reference=" + dir + " " + dir + "/state";
  return "put the newest news.json of the authority's folder into " + dir + "/keys, then: rm " + dir + "/" + kFiles[0] +
         " " + dir + "/" + kFiles[1];
}

Result<TrustUpdate> read_one(const std::string& path, const FleetAuthority& authority) {
  const auto bytes = read_file(path);
  if (!bytes) return bytes.error();
  auto update = decode<TrustUpdate>(*bytes);
  if (!update) return fail(update.error().code, path + ": is damaged: " + update.error().what);
  if (update->revocations.kind.empty()) return update;
  const auto list = open_revocations(update->revocations, authority);
  if (list) return update;
  // The fleet's name is one of the bytes that may be damaged.
  return fail(list.error().code, path + ": is damaged, or of another fleet: " + list.error().what);
}

}  // namespace

Result<StoredUpdates> read_stored_updates(const std::string& node_dir, const FleetAuthority& authority) {
  std::optional<Error> damaged;
  for (const char* file : kFiles) {
    auto update = read_one(node_dir + "/" + file, authority);
    if (update) return StoredUpdates{std::move(*update), damaged};
    if (!damaged && update.error().code != Errc::missing) damaged = update.error();
  }
  if (!damaged) return StoredUpdates{};
  return fail(damaged->code, damaged->what, cure(node_dir, *damaged));
}

Status write_stored_updates(const std::string& node_dir, const TrustUpdate& update) {
  const Bytes bytes = encode(update);
  for (const char* file : kFiles) {
    const std::string path = node_dir + "/" + file;
    // At each start the update is read from this very file.
    if (const auto there = read_file(path); there && *there == bytes) continue;
    if (Status written = write_file(path, bytes); !written) return written;
  }
  return Done{};
}

}  // namespace trb
