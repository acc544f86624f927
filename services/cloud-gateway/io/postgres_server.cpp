#include "services/cloud-gateway/io/postgres_server.hpp"

#include <filesystem>

#include "common/base/files.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kMaxPasswordFile = 1024;

/// A value of libpq's keywords.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return out + "'";
}

bool is_owners_alone(const std::string& path) {
  using std::filesystem::perms;
  std::error_code none;
  const perms mode = std::filesystem::status(path, none).permissions();
  return !none && (mode & (perms::group_all | perms::others_all)) == perms::none;
}

/// The first line. Empty: there is none, the server trusts this user by other means.
Result<std::string> password_in(const std::string& path) {
  if (!file_exists(path)) return std::string();
  if (!is_owners_alone(path)) return fail(Errc::bad_value, path + ": others can read it", "chmod 600 " + path);
  const auto text = read_file(path, kMaxPasswordFile);
  if (!text) return text.error();
  const std::string line = text->substr(0, text->find_first_of("\r\n"));
  if (!line.empty() && line.find('\0') == std::string::npos) return line;
  return fail(Errc::bad_value, path + ": no password in its first line", "write it there, or remove the file");
}

}  // namespace

Result<PostgresServer> postgres_server(const DatabaseAddress& database, const std::string& node_dir) {
  const auto password = password_in(node_dir + "/keys/database.password");
  if (!password) return password.error();
  PostgresServer out;
  out.name = database.text();
  out.connection = "host=" + quoted(database.host) + " port=" + std::to_string(database.port) +
                   " user=" + quoted(database.user) + " dbname=" + quoted(database.name);
  if (!password->empty()) out.connection += " password=" + quoted(*password);
  if (database.is_local()) return out;
  const std::string authority = node_dir + "/keys/database.crt";
  if (!file_exists(authority)) {
    return fail(Errc::missing, authority + ": the database is on another machine, and its authority is not known",
                "put the certificate (PEM) there of the authority that has signed the server's");
  }
  out.connection += " sslmode=verify-full sslrootcert=" + quoted(authority);
  return out;
}

}  // namespace trb::gateway
