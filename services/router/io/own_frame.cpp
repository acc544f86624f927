#include "services/router/io/own_frame.hpp"

#include "proto/message.hpp"

namespace trb::router {

std::optional<Bytes> encode_own(ShellContext& shell, const Message& message) {
  Bytes frame = encode_frame(message);
  const auto readable = decode_frame(frame);
  if (readable) return frame;
  shell.count("dropped." + std::string(errc_name(readable.error().code)));
  shell.log(Level::error, "not_sent", message.subtype + " for '" + message.target + "': " + readable.error().text());
  return std::nullopt;
}

}  // namespace trb::router
