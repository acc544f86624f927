#include "services/virtual-robots/kuka/codec.hpp"

namespace trb::virtual_robots::kuka {
namespace {

/** Reads big-endian fields; after a missing one every further read fails. */
class Fields {
 public:
  explicit Fields(std::string_view bytes) : bytes_(bytes) {}

  std::uint8_t u8() {
    if (!enough(1)) return 0;
    return static_cast<std::uint8_t>(bytes_[at_++]);
  }
  std::uint16_t u16() {
    const unsigned high = u8();
    return static_cast<std::uint16_t>(high * 256 + u8());
  }
  std::string text() {
    const std::size_t size = u16();
    if (!enough(size)) return {};
    at_ += size;
    return std::string(bytes_.substr(at_ - size, size));
  }
  bool complete() const { return ok_ && at_ == bytes_.size(); }

 private:
  bool enough(std::size_t count) {
    ok_ = ok_ && bytes_.size() - at_ >= count;
    return ok_;
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

std::string u16(std::size_t number) {
  return {static_cast<char>(number / 256 % 256), static_cast<char>(number % 256)};
}

}  // namespace

std::optional<Request> take_request(std::string& bytes) {
  if (bytes.size() < 4) return std::nullopt;
  Fields header(std::string_view(bytes).substr(0, 4));
  Request request;
  request.tag = header.u16();
  const std::size_t length = header.u16();
  if (bytes.size() < 4 + length) return std::nullopt;
  const std::string body = bytes.substr(4, length);
  bytes.erase(0, 4 + length);
  Fields fields(body);
  request.type = fields.u8();
  if (request.type > 1) return request;
  request.name = fields.text();
  if (request.type == 1) request.value = fields.text();
  request.well_formed = fields.complete();
  return request;
}

std::string reply(const Request& request, std::string_view value, Code code) {
  std::string body(1, static_cast<char>(request.type));
  if (request.type <= 1) body += u16(value.size()) + std::string(value);
  body += u16(static_cast<std::size_t>(code));
  body += code == Code::success ? '\1' : '\0';
  return u16(request.tag) + u16(body.size()) + body;
}

}  // namespace trb::virtual_robots::kuka
