// Which run of a world a message is of: by the run's id in it, by the tag that stands for it in short forms, or by the
// signature of its start, which a definition has.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/security/keys.hpp"
#include "proto/bodies/run.hpp"
#include "proto/bodies/run_exchange.hpp"
#include "proto/body.hpp"
#include "proto/message.hpp"
#include "services/scheduler/core/run/run_definition.hpp"

namespace trb::world {

class RunMarks {
 public:
  /// From now on its messages are known as those of `run`.
  void add(std::size_t run, const RunStart& start) {
    const Bytes tag = digest(start.run + start.digest.bytes).substr(0, scheduler::RunDefinition::kTagSize);
    marks_.push_back({run, start.run, tag, {}});
  }
  /// Of each message, before it is asked about: its start is signed once the run is submitted.
  void learn(std::string_view subtype, std::string_view frame) {
    if (marks_.empty() || subtype != RunSubmit::kSubtype) return;
    const auto header = decode_frame(frame);
    const auto body = header ? decode<RunSubmit>(header->data) : Result<RunSubmit>(header.error());
    if (!body) return;
    for (Mark& mark : marks_) {
      if (body->start.payload.bytes.find(mark.id) != std::string::npos) mark.signature = body->start.signature.bytes;
    }
  }
  /// nullopt: it is of no run, of several, or locked for a relay.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view frame) const {
    std::optional<std::size_t> out;
    for (const Mark& mark : marks_) {
      const bool has = has_text(frame, mark.id) || has_text(frame, mark.tag) || has_text(frame, mark.signature);
      if (has && out) return std::nullopt;
      if (has) out = mark.run;
    }
    return out;
  }

 private:
  struct Mark {
    std::size_t run = 0;
    std::string id;
    Bytes tag, signature;
  };
  static bool has_text(std::string_view frame, std::string_view text) {
    return !text.empty() && frame.find(text) != std::string_view::npos;
  }
  std::vector<Mark> marks_;
};

}  // namespace trb::world
