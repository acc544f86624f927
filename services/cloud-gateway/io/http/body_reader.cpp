#include "services/cloud-gateway/io/http/body_reader.hpp"

#include <algorithm>

#include "common/base/number_text.hpp"

namespace trb::gateway {
namespace {

/// A chunk's size with its extensions. Nobody uses extensions; long ones would let a client send a hundred times the
/// body.
constexpr std::size_t kMaxChunkLine = 64;
/// All trailers: they are dropped, so this is only room for somebody who sends a checksum.
constexpr std::size_t kMaxTrailers = 1024;

bool is_control(char c) {
  return (static_cast<unsigned char>(c) < ' ' && c != '\t') || c == '\x7f';
}

}  // namespace

BodyReader BodyReader::of_size(std::size_t size) {
  BodyReader out;
  out.left_ = size;
  if (size == 0) out.state_ = State::done;
  return out;
}

BodyReader BodyReader::of_chunks(std::size_t most) {
  BodyReader out;
  out.is_chunked_ = true;
  out.part_ = Part::size_line;
  out.room_ = most;
  return out;
}

BodyReader::State BodyReader::feed(std::string& input) {
  std::size_t used = 0;
  while (state_ == State::more && used < input.size()) {
    const BytesView rest = BytesView(input).substr(used);
    used += part_ == Part::data ? take_data(rest) : take_line(rest);
  }
  input.erase(0, used);
  return state_;
}

std::size_t BodyReader::take_data(BytesView input) {
  const std::size_t count = std::min(left_, input.size());
  body_ += input.substr(0, count);
  left_ -= count;
  if (left_ > 0) return count;
  if (is_chunked_)
    part_ = Part::data_end;
  else
    state_ = State::done;
  return count;
}

std::size_t BodyReader::take_line(BytesView input) {
  const std::size_t end = input.find('\n');
  const std::size_t count = std::min(end, input.size());
  line_ += input.substr(0, count);
  const std::size_t most = part_ == Part::trailer ? kMaxTrailers : kMaxChunkLine;
  if (line_.size() + trailer_ > most) state_ = State::malformed;
  if (end == BytesView::npos) return count;
  on_line();
  line_.clear();
  return count + 1;
}

void BodyReader::on_line() {
  // A bare line feed ends a line for some servers and not for others (RFC 9112, 2.2).
  const bool ends_well = line_.ends_with('\r');
  if (ends_well) line_.pop_back();
  if (!ends_well || std::ranges::any_of(line_, is_control)) state_ = State::malformed;
  if (state_ == State::malformed) return;
  if (part_ == Part::size_line) return begin_chunk();
  if (part_ == Part::data_end) return end_chunk();
  trailer_ += line_.size();
  if (line_.empty()) state_ = State::done;
}

void BodyReader::begin_chunk() {
  const std::string_view digits = std::string_view(line_).substr(0, line_.find_first_of("; \t"));
  const auto size = parse_hex_number<std::uint64_t>(digits);
  if (!size) {
    state_ = State::malformed;
  } else if (*size > room_) {
    state_ = State::too_large;
  } else {
    left_ = static_cast<std::size_t>(*size);
    room_ -= left_;
    part_ = left_ == 0 ? Part::trailer : Part::data;
  }
}

void BodyReader::end_chunk() {
  if (!line_.empty()) state_ = State::malformed;
  part_ = Part::size_line;
}

}  // namespace trb::gateway
