// Messages as the tests of the router make them.
#pragma once

#include <chrono>
#include <string>

#include "proto/message.hpp"
#include "services/router/core/effects.hpp"

namespace trb::router {

using std::chrono::milliseconds;
using Seconds = std::chrono::seconds;
using To = Routing::To;

inline HeaderView header_of(const Message& message, std::uint64_t sequence = 0, LinkId link = 0) {
  HeaderView view = to_view(message);
  view.link = link;
  view.sequence = sequence;
  return view;
}

template <class T>
Message make_message(MessageType type, const std::string& source, const std::string& target, const T& body) {
  Message message;
  message.type = type;
  message.subtype = T::kSubtype;
  message.source = source;
  message.target = target;
  message.id = 77;
  message.data = encode(body);
  return message;
}

}  // namespace trb::router
