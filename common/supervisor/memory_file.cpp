#include "common/supervisor/memory_file.hpp"

#include <sys/mman.h>
#include <unistd.h>

namespace trb::supervisor {

int memory_file(const std::string& bytes) {
  const int file = memfd_create("input", MFD_CLOEXEC);
  if (file < 0) return file;
  const ssize_t written = write(file, bytes.data(), bytes.size());
  if (written == static_cast<ssize_t>(bytes.size()) && lseek(file, 0, SEEK_SET) == 0) return file;
  close(file);
  return -1;
}

}  // namespace trb::supervisor
