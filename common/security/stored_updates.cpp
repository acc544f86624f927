#include "common/security/stored_updates.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "common/base/files.hpp"
#include "common/security/revocations.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

/// The first is written first: if a crash comes between the two, it is the newer one.
constexpr const char* kFiles[] = {"state/news", "state/news.copy"};
constexpr const char* kDropped = "state/dropped";

std::string whole_path(const std::string& node_dir) {
  std::error_code none;
  return std::filesystem::weakly_canonical(node_dir, none).string();
}

std::string give_to_user(const std::string& dir) {
  return "let the node's user read it: chown -R --reference=" + dir + " " + dir + "/state";
}

std::string cure(const std::string& node_dir, const Error& why) {
  const std::string dir = whole_path(node_dir);
  if (why.code == Errc::io_error) return give_to_user(dir);
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

/// Damaged, it must not count as nothing: whom it names would be a member again.
Result<std::vector<Revocation>> read_dropped(const std::string& node_dir) {
  const std::string path = node_dir + "/" + kDropped;
  const auto bytes = read_file(path);
  if (!bytes && bytes.error().code == Errc::missing) return std::vector<Revocation>{};
  const std::string dir = whole_path(node_dir);
  if (!bytes) return fail(bytes.error().code, bytes.error().what, give_to_user(dir));
  auto list = decode<RevocationList>(*bytes);
  if (list) return std::move(list->revoked);
  return fail(list.error().code, path + ": is damaged: " + list.error().what,
              "where the authority is, revoke again whom an older copy of its folder had forgotten (trb fleet revoke), "
              "and tell the fleet by another node; then: rm " +
                  dir + "/" + kDropped);
}

/// These, and whom the file names beside them, as far as a list has room.
std::vector<Revocation> with_stored(const std::string& node_dir, std::vector<Revocation> dropped) {
  constexpr std::size_t kMost = 2000;  // RevocationList's
  const auto before = read_dropped(node_dir);
  for (std::size_t i = 0; before && i < before->size() && dropped.size() < kMost; ++i) {
    const Revocation& entry = (*before)[i];
    if (std::ranges::find(dropped, entry) == dropped.end()) dropped.push_back(entry);
  }
  return dropped;
}

Status write_dropped(const std::string& node_dir, const std::vector<Revocation>& dropped) {
  const std::string path = node_dir + "/" + kDropped;
  if (dropped.empty() && !file_exists(path)) return Done{};
  RevocationList list;
  list.revoked = dropped;
  const Bytes bytes = encode(list);
  if (const auto there = read_file(path); there && *there == bytes) return Done{};
  return write_file(path, bytes);
}

}  // namespace

Result<StoredUpdates> read_stored_updates(const std::string& node_dir, const FleetAuthority& authority) {
  auto dropped = read_dropped(node_dir);
  if (!dropped) return dropped.error();
  std::optional<Error> damaged;
  for (const char* file : kFiles) {
    auto update = read_one(node_dir + "/" + file, authority);
    if (update) return StoredUpdates{std::move(*update), damaged, std::move(*dropped)};
    if (!damaged && update.error().code != Errc::missing) damaged = update.error();
  }
  if (!damaged) return StoredUpdates{{}, std::nullopt, std::move(*dropped)};
  return fail(damaged->code, damaged->what, cure(node_dir, *damaged));
}

Status write_stored_updates(const std::string& node_dir, const TrustUpdate& update,
                            const std::vector<Revocation>& dropped) {
  // A list may lack whom the one before had, or have whom that lacked: until it is stored, both count.
  if (Status written = write_dropped(node_dir, with_stored(node_dir, dropped)); !written) return written;
  const Bytes bytes = encode(update);
  for (const char* file : kFiles) {
    const std::string path = node_dir + "/" + file;
    // At each start the update is read from this very file.
    if (const auto there = read_file(path); there && *there == bytes) continue;
    if (Status written = write_file(path, bytes); !written) return written;
  }
  return write_dropped(node_dir, dropped);
}

}  // namespace trb
