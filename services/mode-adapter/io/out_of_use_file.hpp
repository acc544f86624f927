// Keeps what is out of use over a restart: NODE_DIR/state/out_of_use.json.
#pragma once

#include <string>

#include "services/mode-adapter/core/out_of_use_book.hpp"

namespace trb::adapter {

class OutOfUseFile {
 public:
  explicit OutOfUseFile(const std::string& node_dir);

  /// Empty if there is no file. A file that cannot be read keeps the whole robot out of use until a person has looked.
  [[nodiscard]] std::vector<Kept> read() const;
  /// Errors: io_error, naming the file; the previous contents stay intact.
  Status save(const std::vector<Kept>& lines) const;

 private:
  std::string path_;
};

}  // namespace trb::adapter
