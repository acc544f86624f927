// node backup, node restore: what a node must have to run on another PC.
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>

#include "common/base/files.hpp"
#include "common/base/ids.hpp"
#include "common/config/node_config.hpp"
#include "common/drivers/registry.hpp"
#include "common/operator/io/socket_address.hpp"
#include "common/security/keys.hpp"
#include "common/security/passphrase_box.hpp"
#include "common/supervisor/node_lock.hpp"
#include "common/transport/loop.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/io/node_backup_files.hpp"
#include "services/cli/io/node_folder.hpp"
#include "services/cli/io/passphrase.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

constexpr const char* kOfBackup = "passphrase of the backup";

/// A path of any length: by the folder's descriptor.
bool socket_listens(const std::string& dir) {
  const int folder = ::open((dir + "/bus").c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return false;
  const std::string path = "/proc/self/fd/" + std::to_string(folder) + "/probe.ipc";
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  std::memcpy(to.sun_path, path.c_str(), path.size() + 1);
  const bool listens = socket >= 0 && ::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  if (socket >= 0) ::close(socket);
  ::close(folder);
  return listens;
}

/// Does anybody take connections at this end of a bus over TCP?
bool port_listens(const std::string& bus) {
  const auto at = op::socket_address(bus);
  if (!at) return false;
  const int socket = ::socket(at->family(), SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval most{2, 0};  // a firewall may be silent
  const bool listens = socket >= 0 && ::setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &most, sizeof most) == 0 &&
                       ::connect(socket, at->data(), at->size) == 0;
  if (socket >= 0) ::close(socket);
  return listens;
}

/// Does a router answer on the node's bus? One that no `trb up` has started holds no lock.
bool router_listens(const std::string& dir) {
  const auto bus = read_bus(dir);
  return socket_listens(dir) || (bus && !bus->empty() && port_listens(*bus));
}

Result<supervisor::NodeLock> lock_stopped(const std::string& dir) {
  if (Status there = find_node_json(dir, "name a node's folder"); !there) return there.error();
  if (router_listens(dir)) {
    return fail(
        Errc::conflict, dir + " is up: its router answers",
        "stop it first (trb down " + dir +
            "; with systemd, which starts it again: systemctl stop talkrobots): what it writes meanwhile would be "
            "in the backup by halves");
  }
  return supervisor::NodeLock::take(dir);
}

Status write_new(const std::string& file, BytesView bytes) {
  if (file_exists(file)) return fail(Errc::conflict, file + " is there already", "name a new file");
  const Status written = write_file(file, bytes, 0600);
  if (written || !written.error().hint.empty()) return written;
  return fail(written.error().code, written.error().what, "name a file in a folder that is there, with room (df -h)");
}

/// Read without the rest of the folder: one with faults can be kept, too.
Result<std::string> id_in(const std::string& dir) {
  const auto text = read_file(dir + "/node.json");
  if (!text) return text.error();
  const auto json = parse_json(*text);
  const Value* id = json ? json->find("id") : nullptr;
  if (id == nullptr || !id->is_text())
    return fail(Errc::malformed, dir + "/node.json: id: missing", "trb check " + dir);
  if (Status good = check_id("id", id->text()); !good) return good.error();
  return id->text();
}

Result<NodeBackup> make_backup(const Arguments& arguments, const std::string& dir, const std::string& file) {
  const auto lock = lock_stopped(dir);
  if (!lock) return lock.error();
  const auto id = id_in(dir);
  if (!id) return id.error();
  auto backup = read_node_folder(dir, *id);
  if (!backup) return backup.error();
  const auto packed = pack(*backup);
  if (!packed) return packed.error();
  const auto passphrase = ask_for_passphrase(arguments, true, kOfBackup);
  if (!passphrase) return passphrase.error();
  const auto locked = lock_with_passphrase(*packed, *passphrase);
  if (!locked) return locked.error();
  if (Status written = write_new(file, Bytes(kBackupHead) + *locked); !written) return written.error();
  return backup;
}

int run_backup(const Arguments& arguments) {
  init_crypto();
  const std::string dir = plain_folder(arguments.words[0]);
  const std::string& file = arguments.words[1];
  const auto backup = make_backup(arguments, dir, file);
  if (!backup) return print_error(arguments, backup.error());
  if (arguments.has("--json")) {
    print_json(Value{Value::Object{{"node", Value{backup->node}},
                                   {"file", Value{file}},
                                   {"files", Value{static_cast<std::int64_t>(backup->files.size())}}}});
    return kGood;
  }
  print_line(file + ": " + backup->node + ", " + std::to_string(backup->files.size()) +
             " files, with its secret keys; locked with the passphrase");
  print_line("not in it: log/ with the log of proof (copy it, if you need it), what the node knows of runs and alerts");
  return kGood;
}

Result<NodeBackup> read_backup(const Arguments& arguments, const std::string& path) {
  const auto bytes = read_file(path, kBackupBytes + (std::size_t{4} << 20U));
  if (!bytes) return fail(bytes.error().code, bytes.error().what, "name a file that trb node backup has made");
  constexpr std::string_view kAnyHead = "talkrobots node backup ";
  if (!bytes->starts_with(kAnyHead))
    return fail(Errc::malformed, path + ": no backup of a node", "name a file that trb node backup has made");
  if (!bytes->starts_with(kBackupHead)) {
    return fail(Errc::version_mismatch, path + ": a newer trb has made it",
                "install that version, and restore it there; the file is untouched");
  }
  const auto passphrase = ask_for_passphrase(arguments, false, kOfBackup);
  if (!passphrase) return passphrase.error();
  const auto packed = open_with_passphrase(BytesView(*bytes).substr(kBackupHead.size()), *passphrase, path);
  return packed ? unpack(*packed) : packed.error();
}

void print_restored(const NodeBackup& backup, const std::string& dir, const ConfigFaults& faults) {
  print_line("made " + dir + ": " + backup.node + " as it was at " + to_iso8601({backup.made_s * 1'000'000'000}));
  print_line("its old PC must not run any more: of two nodes with the same keys the fleet takes one");
  print_line("next:");
  if (!faults.empty()) print("  put right           what trb check " + dir + " says:\n" + to_text(faults));
  for (const std::string& step : next_steps(backup, dir)) print_line("  " + step);
}

int run_restore(const Arguments& arguments) {
  init_crypto();
  const std::string dir = plain_folder(arguments.words[1]);
  const auto backup = read_backup(arguments, arguments.words[0]);
  if (!backup) return print_error(arguments, backup.error());
  const auto boot = restored_boot(*backup, read_clocks().utc.ns / 1'000'000'000);
  if (!boot) return print_error(arguments, boot.error());
  if (Status written = write_node_folder(*backup, *boot, dir); !written) return print_error(arguments, written.error());
  const ConfigFaults faults = check_node_dir(dir, false, drivers::robot_transports()).faults;
  if (arguments.has("--json")) {
    print_json(Value{Value::Object{{"node", Value{backup->node}},
                                   {"dir", Value{dir}},
                                   {"made", Value{to_iso8601({backup->made_s * 1'000'000'000})}},
                                   {"faults", *faults_json(faults).find("faults")}}});
    return kGood;
  }
  print_restored(*backup, dir, faults);
  return kGood;
}

const std::vector<Command> kNodeBackupCommands = {
    {{"node", "backup"},
     {"node backup DIR FILE",
      "Writes what a stopped node must have to run on another PC: its files, keys and certificate, revocations, users "
      "of "
      "a cloud. The file holds secret keys, and is locked with a passphrase.",
      {"--passphrase-file FILE|its first line (else TRB_PASSPHRASE, else it is asked for)", kJson},
      {"trb node backup nodes/arm1 arm1.backup"},
      2,
      2},
     run_backup},
    {{"node", "restore"},
     {"node restore FILE DIR",
      "Makes a node's folder from a backup. What the node did since then is not in it: its robot stays out of use "
      "until "
      "a person has looked at it (trb robot repaired) and releases it.",
      {"--passphrase-file FILE|its first line (else TRB_PASSPHRASE, else it is asked for)", kJson},
      {"trb node restore arm1.backup nodes/arm1"},
      2,
      2},
     run_restore},
};

}  // namespace

std::vector<Command> node_backup_commands() {
  return kNodeBackupCommands;
}

}  // namespace trb::cli
