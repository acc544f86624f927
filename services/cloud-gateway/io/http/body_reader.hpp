// A request's body, as its bytes come.
#pragma once

#include <cstdint>
#include <string>

#include "common/base/bytes.hpp"

namespace trb::gateway {

/// Of an announced size, or in chunks (RFC 9112, 7.1), whose extensions and trailers are dropped. It is not left to
/// Beast, which mixes trailers among the headers, and in 1.74 asserts on a last chunk that comes in pieces.
class BodyReader {
 public:
  /// `size` must have been checked.
  static BodyReader of_size(std::size_t size);
  /// `most`: bytes of all chunks.
  static BodyReader of_chunks(std::size_t most);

  enum class State { more, done, too_large, malformed };
  /// Takes what belongs to the body from the front of `input`.
  State feed(std::string& input);
  [[nodiscard]] State state() const { return state_; }
  /// After `done`, once.
  Bytes take() { return std::move(body_); }

 private:
  enum class Part { size_line, data, data_end, trailer };
  BodyReader() = default;
  std::size_t take_data(BytesView input);
  std::size_t take_line(BytesView input);
  void on_line();
  void begin_chunk();
  void end_chunk();

  bool is_chunked_ = false;
  Part part_ = Part::data;
  State state_ = State::more;
  std::size_t left_ = 0;  ///< of the body, or of this chunk
  std::size_t room_ = 0;  ///< for further chunks
  std::size_t trailer_ = 0;
  std::string line_;
  Bytes body_;
};

}  // namespace trb::gateway
