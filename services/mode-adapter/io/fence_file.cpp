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
  if (fenced) return write_file(path_, "fenced\n") ? Status(Done{}) : make_empty();
  if (::unlink(path_.c_str()) != 0 && errno != ENOENT) {
    return fail(Errc::io_error, path_ + ": " + std::strerror(errno), "remove it by hand");
  }
  // If the removal is lost in a power cut, the node merely starts fenced.
  const int folder = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
  return Done{};
}

/// The file's existence is the fence: a full disk has room for an empty file.
Status FenceFile::make_empty() const {
  const int file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  const bool made = file >= 0 && ::fsync(file) == 0;
  const std::string why = std::strerror(errno);
  if (file >= 0) ::close(file);
  const int folder = made ? ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
  const bool kept = folder >= 0 && ::fsync(folder) == 0;
  if (folder >= 0) ::close(folder);
  if (kept) return Done{};
  return fail(Errc::io_error, path_ + ": cannot be made: " + why,
              "make room there (df -h " + folder_ + "); it is tried again every second");
}

}  // namespace trb::adapter
