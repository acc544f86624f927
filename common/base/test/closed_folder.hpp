// A folder that the test's user may not look into, or not write.
#pragma once

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <utility>

namespace trb {

/// While it exists, the folder has this mode: by default nobody may look into it. Root, who could, has the rights of
/// nobody.
class ClosedFolder {
 public:
  explicit ClosedFolder(std::string path, mode_t mode = 0) : path_(std::move(path)) {
    REQUIRE(::chmod(path_.c_str(), mode) == 0);
    if (former_ == 0) REQUIRE(::seteuid(kNobody) == 0);
  }
  ~ClosedFolder() {
    CHECK(::seteuid(former_) == 0);
    ::chmod(path_.c_str(), 0700);
  }
  ClosedFolder(const ClosedFolder&) = delete;
  ClosedFolder& operator=(const ClosedFolder&) = delete;

 private:
  static constexpr uid_t kNobody = 65534;
  std::string path_;
  uid_t former_ = ::geteuid();
};

}  // namespace trb
