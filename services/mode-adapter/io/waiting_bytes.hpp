// Bytes that wait to be written to a stream, which takes them piece by piece.
#pragma once

#include <cstddef>

#include "common/base/bytes.hpp"

namespace trb::adapter {

/// What was written is freed in portions: a reader that is always a little behind never takes all, and what it has
/// taken would pile up. A portion is at least as large as what is moved for it, so each byte is moved once at most.
class WaitingBytes {
 public:
  void add(BytesView bytes) { bytes_ += bytes; }
  /// What was not written yet.
  [[nodiscard]] BytesView rest() const { return BytesView(bytes_).substr(written_); }
  /// How many bytes that is.
  [[nodiscard]] std::size_t size() const { return bytes_.size() - written_; }
  [[nodiscard]] bool empty() const { return size() == 0; }
  /// So many bytes of rest() were written.
  void written(std::size_t size) {
    written_ += size;
    if (empty()) return clear();
    if (written_ < kPortion || written_ < this->size()) return;
    bytes_.erase(0, written_);
    written_ = 0;
  }
  void clear() {
    bytes_.clear();
    written_ = 0;
  }
  /// The bytes in memory, those included that were written: size() and the larger of kPortion and size() at most.
  [[nodiscard]] std::size_t kept() const { return bytes_.size(); }

  static constexpr std::size_t kPortion = 64U << 10U;

 private:
  Bytes bytes_;
  std::size_t written_ = 0;
};

}  // namespace trb::adapter
