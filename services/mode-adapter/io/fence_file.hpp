// The fence outlives the process: it is set while the file exists.
#pragma once

#include <string>

#include "common/base/result.hpp"

namespace trb::adapter {

class FenceFile {
 public:
  explicit FenceFile(std::string node_dir);

  [[nodiscard]] bool set() const;
  /// Errors: io_error, naming the file.
  Status save(bool fenced) const;

 private:
  [[nodiscard]] Status make_empty() const;

  std::string folder_;
  std::string path_;
};

}  // namespace trb::adapter
