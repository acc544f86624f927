// The message of section 3.2.3 (type, subtype, source, target, size, data) and its form on a ZeroMQ wire.
//
// One ZeroMQ frame: a fixed prefix of 24 bytes that a router rewrites in place, a msgpack array of six, then the data.
// proto/README.md has the grammar.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "proto/field.hpp"

namespace trb {

enum class MessageType : std::uint8_t { none = 0, command = 1, request = 2, information = 3 };
constexpr auto enum_names(MessageType) {
  return std::array<std::string_view, 4>{"none", "command", "request", "information"};
}

constexpr std::uint8_t kWireVersion = 2;  ///< 2: relayed frames are encrypted, certificates say who may relay
constexpr std::size_t kPrefixSize = 24;
constexpr std::size_t kMaxDataSize = 1U << 20U;  ///< 1 MiB
constexpr std::size_t kMaxFrameSize = kMaxDataSize + 1024;
constexpr std::uint32_t kDefaultRemainingMs = 10'000;
constexpr std::string_view kEveryNode = "*";  ///< as target: every linked node (information only)

/// Bits of Header::flags.
enum MessageFlags : std::uint16_t {
  kFlagNoAnswer = 1,     ///< the sender wants no answer to this command except a Nack
  kFlagTakeControl = 2,  ///< this command takes the control lease of the robot from its holder
  kFlagLossy = 4,        ///< information that may be lost: goes by the lane; never what recovery needs
};

/// The parts of a message that a router reads. The texts point into the frame.
struct HeaderView {
  MessageType type = MessageType::none;
  std::uint16_t flags = 0;
  std::uint32_t remaining_ms = 0;  ///< what is left of the message's deadline
  std::uint64_t link = 0;          ///< id of the router-to-router link; 0 on a node's own bus
  std::uint64_t sequence = 0;      ///< number on that link, from 1
  std::string_view subtype;
  std::string_view source;
  std::string_view target;
  std::uint64_t id = 0;        ///< unique at its source; the upper 16 bits are the service's slot
  std::uint64_t reply_to = 0;  ///< id of the command or request that this message answers, or 0
  std::string_view data;
};

/// A message with its own storage.
struct Message {
  MessageType type = MessageType::none;
  std::uint16_t flags = 0;
  std::uint32_t remaining_ms = kDefaultRemainingMs;
  std::string subtype;
  std::string source;
  std::string target;
  std::uint64_t id = 0;
  std::uint64_t reply_to = 0;
  Bytes data;

  bool operator==(const Message&) const = default;
};

/// The frame of a message, with link and sequence 0.
Bytes encode_frame(const Message& message);

/// Reads a frame. Errors: too_large, version_mismatch, malformed (naming the field), bad_value.
/// The view is valid as long as the frame.
Result<HeaderView> decode_frame(BytesView frame);

/// The version in a frame; 0 for an empty frame.
std::uint8_t wire_version(BytesView frame);
/// The same for a frame of any version: prefix and header are alike in all of them, so that a node of another version
/// can be refused by name, with a reason in its own version.
Result<HeaderView> decode_frame_of_any_version(BytesView frame);
void stamp_version(char* frame, std::uint8_t version);

/// Copies a view into a message with its own storage.
Message to_message(const HeaderView& view);
/// The inverse, with link and sequence 0; valid as long as the message.
HeaderView to_view(const Message& message);

/// The remaining time of a frame that decode_frame accepted.
std::uint32_t decode_remaining(BytesView frame);

/// Rewrites the remaining time of a frame that decode_frame accepted.
void stamp_remaining(char* frame, std::uint32_t remaining_ms);

/// Rewrites link, sequence and remaining time in a frame that decode_frame accepted.
void stamp_link(char* frame, std::uint64_t link, std::uint64_t sequence, std::uint32_t remaining_ms);

/// {"type":"command","subtype":…,"source":…,"target":…,"id":…,"reply_to":…,"size":…,"data":…}; data that is not UTF-8
/// goes as "data_hex", the data of a typed subtype as "body" if that is at most 1 MiB and 100,000 values.
std::string message_to_json(const Message& message);

/// The inverse; flags and remaining time are not in JSON. Errors: malformed, missing, bad_value, too_large,
/// unknown_key.
Result<Message> message_from_json(std::string_view json);

}  // namespace trb
