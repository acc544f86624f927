#include "services/cloud-gateway/io/store/private_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace trb::gateway {
namespace {

Error not_private(const std::string& path, const std::string& why) {
  return fail(Errc::io_error, path + ": cannot be made private: " + why,
              "give the folder and the file to the user who runs the gateway");
}

bool is_plain_file(const std::string& path) {
  struct stat is {};
  return ::stat(path.c_str(), &is) == 0 && S_ISREG(is.st_mode);
}

}  // namespace

/// One that is there already is not opened for this: closing it would end the locks that this process has on it.
Status make_private(const std::string& path) {
  const int made = ::open(path.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0600);
  if (made >= 0) ::close(made);
  if (made < 0 && errno != EEXIST) return not_private(path, std::strerror(errno));
  if (!is_plain_file(path)) return not_private(path, "it is no file");
  if (::chmod(path.c_str(), 0600) != 0) return not_private(path, std::strerror(errno));
  return Done{};
}

}  // namespace trb::gateway
