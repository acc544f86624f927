// A robot's answers from a stream, however it is cut.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb::drivers {

class AnswerReader {
 public:
  static constexpr std::size_t kMost = 65536;

  /// `end` is not empty.
  explicit AnswerReader(std::string end) : end_(std::move(end)) {}

  /// The answers that are whole, without their ends and the blanks and line ends around them; what is empty then is no
  /// answer. Errors: too_large (the connection can no longer be used).
  Result<std::vector<std::string>> add(BytesView bytes);
  void clear();

 private:
  std::string end_;
  Bytes rest_;
  std::size_t seen_ = 0;  ///< so much of it has no end
};

}  // namespace trb::drivers
