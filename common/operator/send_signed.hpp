// Orders that stay valid after their message: signed by the node's router, then sent to the node's scheduler.
#pragma once

#include <string_view>

#include "common/operator/session.hpp"

namespace trb::op {

/// Has the record signed as `kind`, and sends it to the own node as an `Order` (RunSubmit, RunAbort, RunPause). `done`
/// gets the scheduler's answer.
template <class Order>
void send_signed(Session& session, std::string_view kind, Bytes record, const Callback<Message>& done) {
  const auto send = [&session, done](SignedRecord signature) {
    session.command(session.node(), Order{std::move(signature)}, done);
  };
  session.ask_node<SignedRecord>(SignRequest{std::string(kind), {std::move(record)}},
                                 on_success<SignedRecord>(done, send));
}

}  // namespace trb::op
