#include "services/cli/core/node_backup.hpp"

#include <algorithm>
#include <set>

#include "common/base/ids.hpp"
#include "common/base/number_text.hpp"
#include "proto/value.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kPath = 255;
constexpr std::size_t kManifest = std::size_t{2} << 20U;
constexpr std::string_view kBoot = "state/boot";
constexpr std::string_view kOfState[] = {kBoot,
                                         "state/utc",
                                         "state/news",
                                         "state/dropped",
                                         "state/news.copy",
                                         "state/peers",
                                         "state/fence",
                                         "state/out_of_use.json",
                                         "state/gateway.db"};

bool is_part(std::string_view part) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  return !part.empty() && part != "." && part != ".." && std::ranges::none_of(part, is_control);
}

/// Each part between the slashes is a name.
bool stays_inside(std::string_view path) {
  if (path.size() > kPath) return false;
  while (true) {
    const std::size_t slash = path.find('/');
    if (!is_part(path.substr(0, slash))) return false;
    if (slash == std::string_view::npos) return true;
    path.remove_prefix(slash + 1);
  }
}

Error bad(const std::string& what) {
  return fail(Errc::malformed, "the backup: " + what, "take another one: this file was not made by trb node backup");
}

Error too_large(const std::string& what) {
  return fail(Errc::too_large, what,
              "a backup has at most " + std::to_string(kBackupFiles) + " files and " +
                  std::to_string(kBackupBytes >> 20U) + " MiB");
}

Value row_of(const BackupFile& file) {
  return Value{Value::Object{{"path", Value{file.path}},
                             {"mode", Value{std::int64_t{file.mode}}},
                             {"size", Value{static_cast<std::int64_t>(file.bytes.size())}}}};
}

Result<std::int64_t> integer_of(const Value& row, std::string_view key, std::int64_t most) {
  const Value* value = row.find(key);
  if (value == nullptr || !value->is_integer() || value->integer() < 0 || value->integer() > most) {
    return bad(std::string(key) + ": missing, or no number from 0 to " + std::to_string(most));
  }
  return value->integer();
}

Result<std::string> text_of(const Value& row, std::string_view key) {
  const Value* value = row.find(key);
  if (value == nullptr || !value->is_text() || value->text().size() > kPath)
    return bad(std::string(key) + ": missing, or no text of at most 255 bytes");
  return value->text();
}

/// Takes the file's bytes from the front of `rest`.
Result<BackupFile> read_file_of(const Value& row, BytesView& rest) {
  auto path = text_of(row, "path");
  if (!path) return path.error();
  if (!is_kept(*path)) return fail(Errc::bad_value, "the backup: '" + *path + "' may not be in one");
  const auto mode = integer_of(row, "mode", 0755);
  if (!mode) return mode.error();
  const auto size = integer_of(row, "size", static_cast<std::int64_t>(kBackupBytes));
  if (!size) return size.error();
  if (static_cast<std::uint64_t>(*size) > rest.size()) return bad("'" + *path + "' is cut short");
  BackupFile file{std::move(*path), static_cast<unsigned>(*mode),
                  Bytes(rest.substr(0, static_cast<std::size_t>(*size)))};
  rest.remove_prefix(file.bytes.size());
  return file;
}

Status read_files(const Value& json, BytesView rest, NodeBackup& backup) {
  const Value* rows = json.find("files");
  if (rows == nullptr || !rows->is_list()) return bad("files: missing");
  std::set<std::string> paths;
  for (const Value& row : std::get<Value::List>(rows->is)) {
    auto file = read_file_of(row, rest);
    if (!file) return file.error();
    if (!paths.insert(file->path).second || backup.files.size() == kBackupFiles)
      return bad("'" + file->path + "' is there twice, or is one file too many");
    backup.files.push_back(std::move(*file));
  }
  if (!rest.empty()) return bad(std::to_string(rest.size()) + " bytes belong to no file");
  return Done{};
}

}  // namespace

bool has_robot(const NodeBackup& backup) {
  const auto file = std::ranges::find(backup.files, "node.json", &BackupFile::path);
  const auto json = file == backup.files.end() ? Result<Value>(Value{}) : parse_json(file->bytes);
  const Value* role = json ? json->find("role") : nullptr;
  return role == nullptr || !role->is_text() || role->text() != "cloud";
}

std::vector<std::string> next_steps(const NodeBackup& backup, const std::string& dir) {
  std::vector<std::string> steps{"start it            trb up " + dir};
  if (has_robot(backup)) {
    steps.push_back("look at its robot   what it holds and does: what it did since is not known");
    steps.push_back("then use it again   trb robot repaired " + backup.node + "; trb release " + backup.node);
  } else {
    steps.push_back("sign in again       nobody is signed in, and no token is valid; trb cloud password " + dir +
                    " makes an admin");
    steps.push_back(
        "look at the users   they are as they were then: who was removed, locked or given less since is there again,");
    steps.push_back("                    with the old password; who was added since is not. On the page: Users");
    steps.push_back(
        "its audit log       lacks what people did since; it goes on with a record \"restored\", whose number is");
    steps.push_back("                    its time in ms. trb audit verify OLDER NEWER tells where two exports part");
  }
  return steps;
}

Status check_no_authority(const NodeBackup& backup) {
  for (const BackupFile& file : backup.files) {
    const std::string folder = file.path.substr(0, file.path.rfind('/') + 1);
    const auto is_there = [&](const std::string& name) {
      return std::ranges::find(backup.files, folder + name, &BackupFile::path) != backup.files.end();
    };
    if (file.path != folder + "authority.key" || !is_there("fleet.json")) continue;
    return fail(Errc::bad_value,
                "'" + folder +
                    "' is the folder of the fleet's authority: whoever has it and its "
                    "passphrase is the fleet's master",
                "move it out of the node's folder, to a computer of its own; it has a backup of its own");
  }
  return Done{};
}

bool is_kept(std::string_view path) {
  if (!stays_inside(path)) return false;
  const std::string_view first = path.substr(0, path.find('/'));
  if (first == "state") return std::ranges::find(kOfState, path) != std::end(kOfState);
  return first != "bus" && first != "log";
}

Result<Bytes> pack(const NodeBackup& backup) {
  std::size_t all = 0;
  Value::List rows;
  for (const BackupFile& file : backup.files) {
    all += file.bytes.size();
    rows.push_back(row_of(file));
    if (all > kBackupBytes || rows.size() > kBackupFiles)
      return too_large("'" + file.path + "' is too much for a backup");
  }
  Bytes out = dump_json(Value{Value::Object{{"node", Value{backup.node}},
                                            {"version", Value{backup.version}},
                                            {"made_s", Value{backup.made_s}},
                                            {"files", Value{std::move(rows)}}}});
  if (out.size() > kManifest) return too_large("the names of the files are too long");
  out.reserve(out.size() + 1 + all);
  out += '\n';
  for (const BackupFile& file : backup.files) out += file.bytes;
  return out;
}

Result<NodeBackup> unpack(BytesView bytes) {
  const std::size_t end = bytes.substr(0, kManifest + 1).find('\n');
  if (end == BytesView::npos || bytes.size() - end > kBackupBytes + 1) return bad("its list of files has no end");
  const auto json = parse_json(bytes.substr(0, end), {.bytes = kManifest});
  if (!json) return bad(json.error().what);
  NodeBackup backup;
  auto node = text_of(*json, "node");
  if (!node) return node.error();
  if (Status good = check_id("node", *node); !good) return good.error();
  auto version = text_of(*json, "version");
  if (!version) return version.error();
  const auto made = integer_of(*json, "made_s", std::int64_t{1} << 40U);
  if (!made) return made.error();
  backup.node = std::move(*node);
  backup.version = std::move(*version);
  backup.made_s = *made;
  if (Status read = read_files(*json, bytes.substr(end + 1), backup); !read) return read.error();
  return backup;
}

unsigned restored_mode(const BackupFile& file) {
  const bool secret = file.path.ends_with(".key") || file.path.ends_with(".auth") || file.path.starts_with("state/");
  return (file.mode | 0600U) & (secret ? 0700U : 0755U);
}

Result<std::uint64_t> restored_boot(const NodeBackup& backup, std::int64_t now_s) {
  if (now_s < backup.made_s) {
    return fail(Errc::conflict,
                "this computer's clock is " + std::to_string(backup.made_s - now_s) + " s before the backup was made",
                "set the clock: peers refuse a node that counts its starts anew");
  }
  std::uint64_t boot = static_cast<std::uint64_t>(now_s);
  for (const BackupFile& file : backup.files) {
    if (file.path != kBoot) continue;
    const auto counted = parse_number<std::uint64_t>(std::string(file.bytes.substr(0, file.bytes.find('\n'))));
    if (counted) boot = std::max(boot, *counted);
  }
  return boot;
}

}  // namespace trb::cli
