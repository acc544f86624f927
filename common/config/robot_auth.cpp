#include "common/config/robot_auth.hpp"

#include <sodium.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "common/base/files.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb {
namespace {

constexpr std::size_t kMost = 4096;
constexpr const char* kName = "keys/robot.auth";
const std::string kLine = std::string("write ") + kSignInLine;

std::string path_in(const std::string& node_dir) {
  return node_dir + "/" + kName;
}

std::string base64(const std::string& text) {
  std::string out(sodium_base64_ENCODED_LEN(text.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(out.data(), out.size(), reinterpret_cast<const unsigned char*>(text.data()), text.size(),
                    sodium_base64_VARIANT_ORIGINAL);
  out.resize(out.size() - 1);  // the terminating zero byte
  return out;
}

Result<std::string> header_of(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const std::size_t blank = text.find(' ');
  const std::string scheme = text.substr(0, blank);
  const std::string secret = blank == std::string::npos ? "" : text.substr(blank + 1);
  const bool one_line = std::ranges::all_of(secret, [](char c) { return c > ' ' && c < '\x7f'; });
  const bool is_pair = secret.find(':') != std::string::npos && secret.find('\n') == std::string::npos;
  if (scheme == "basic" && is_pair) return "Basic " + base64(secret);
  if (scheme == "digest" && is_pair && secret.front() != ':') return "Digest " + secret;
  if (scheme == "bearer" && !secret.empty() && one_line) return "Bearer " + secret;
  return fail(Errc::malformed, "is no sign-in", kLine);
}

/// Its errors do not name the file.
Result<std::string> read(const std::string& path) {
  struct stat is {};
  if (::stat(path.c_str(), &is) != 0) {
    if (errno == ENOENT || errno == ENOTDIR) return std::string();
    return fail(Errc::io_error, std::string("cannot look at it: ") + std::strerror(errno),
                "let the services' user own the folder: chown");
  }
  // A pipe in its place would keep the reader waiting.
  if (!S_ISREG(is.st_mode)) return fail(Errc::malformed, "is no file", "remove it, then " + kLine);
  if ((is.st_mode & 0777U) != 0600) return fail(Errc::not_permitted, "others may read it", "chmod 600 " + path);
  auto text = read_file(path, kMost);
  if (text) return header_of(std::move(*text));
  if (text.error().code == Errc::too_large) return fail(Errc::malformed, "is no sign-in", kLine);
  return fail(Errc::io_error, "cannot be read", "let the services' user own it: chown USER " + path);
}

}  // namespace

Result<std::string> read_robot_auth(const std::string& node_dir) {
  const std::string path = path_in(node_dir);
  auto header = read(path);
  if (!header) return fail(header.error().code, path + ": " + header.error().what, header.error().hint);
  return header;
}

void check_robot_auth(const std::string& node_dir, ConfigFaults& faults) {
  const auto header = read(path_in(node_dir));
  if (!header) FileFaults(kName, faults).add("", header.error().what, header.error().hint);
}

}  // namespace trb
