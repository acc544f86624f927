#include "services/mode-adapter/io/robot_auth.hpp"

#include <sodium.h>
#include <sys/stat.h>

#include <algorithm>

#include "common/base/files.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kMost = 4096;

std::string base64(const std::string& text) {
  std::string out(sodium_base64_ENCODED_LEN(text.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(out.data(), out.size(), reinterpret_cast<const unsigned char*>(text.data()), text.size(),
                    sodium_base64_VARIANT_ORIGINAL);
  out.resize(out.size() - 1);  // the terminating zero byte
  return out;
}

}  // namespace

Result<std::string> read_robot_auth(const std::string& node_dir) {
  const std::string path = node_dir + "/keys/robot.auth";
  if (!file_exists(path)) return std::string();
  struct stat is {};
  if (::stat(path.c_str(), &is) != 0 || (is.st_mode & 0777U) != 0600) {
    return fail(Errc::not_permitted, path + ": others may read it", "chmod 600 " + path);
  }
  auto text = read_file(path, kMost);
  if (!text) return text.error();
  while (!text->empty() && (text->back() == '\n' || text->back() == '\r')) text->pop_back();
  const std::size_t blank = text->find(' ');
  const std::string scheme = text->substr(0, blank);
  const std::string secret = blank == std::string::npos ? "" : text->substr(blank + 1);
  const bool one_line = std::ranges::all_of(secret, [](char c) { return c > ' ' && c < '\x7f'; });
  if (scheme == "basic" && !secret.empty() && secret.find(':') != std::string::npos &&
      secret.find('\n') == std::string::npos) {
    return "Basic " + base64(secret);
  }
  if (scheme == "bearer" && !secret.empty() && one_line) return "Bearer " + secret;
  return fail(Errc::malformed, path + ": is no sign-in", "write one line: basic USER:PASSWORD, or bearer TOKEN");
}

}  // namespace trb::adapter
