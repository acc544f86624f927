// A folder that the test's user may not look into.
#pragma once

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <utility>

namespace trb {

/// While it exists, nobody may look into the folder; root, who could, has the rights of nobody.
class ClosedFolder {
 public:
  explicit ClosedFolder(std::string path) : path_(std::move(path)) {
    REQUIRE(::chmod(path_.c_str(), 0) == 0);
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
