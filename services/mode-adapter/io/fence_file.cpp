#include "services/mode-adapter/io/fence_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/base/files.hpp"

namespace trb::adapter {

FenceFile::FenceFile(std::string node_dir) : folder_(std::move(node_dir) + "/state"), path_(folder_ + "/fence") {}

bool FenceFile::set() const {
  return file_exists(path_);
}

Status FenceFile::save(bool fenced) const {
  if (fenced) return write_file(path_, "fenced\n");
  if (::unlink(path_.c_str()) != 0 && errno != ENOENT) {
    return fail(Errc::io_error, path_ + ": " + std::strerror(errno), "remove it by hand");
  }
  // Were it to come back with a power cut, the node would merely boot fenced.
  const int folder = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
  return Done{};
}

}  // namespace trb::adapter
