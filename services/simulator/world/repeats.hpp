// Whether anything that was owed was sent again: while nothing fails, nobody has to.
#pragma once

#include <set>
#include <string>

#include "common/base/varint.hpp"
#include "proto/bodies/run_exchange.hpp"
#include "proto/body.hpp"
#include "proto/message.hpp"
#include "services/scheduler/core/run/run_definition.hpp"
#include "services/simulator/world/meter.hpp"
#include "services/simulator/world/run_marks.hpp"

namespace trb::world {

class Repeats {
 public:
  /// `marks`: of the world's runs, for the first batons of two of them are alike.
  void on(const Sending& sending, std::string_view frame, const RunMarks& marks) {
    const bool owed = sending.subtype == Baton::kSubtype || sending.subtype == Results::kSubtype;
    if (!owed || !sending.between_computers) return;
    const auto header = decode_frame(frame);
    if (!header) return;
    const std::string body = sending.subtype == Baton::kSubtype ? content_of(decode<Baton>(header->data))
                                                                : content_of(decode<Results>(header->data));
    const auto run = marks.find(frame);
    const std::string what = std::string(sending.from) + "\n" + std::string(sending.to) + "\n" +
                             std::string(sending.subtype) + "\n" + (run ? std::to_string(*run) : "") + "\n" + body;
    if (!seen_.insert(what).second && first_.empty())
      first_ = std::string(sending.from) + " has sent " + std::string(sending.to) + " the same " +
               std::string(sending.subtype) + " again";
  }
  /// Empty: nothing was.
  [[nodiscard]] const std::string& first() const { return first_; }

 private:
  /// The same in long and in short form: what is sent again has the long one.
  template <class Message>
  static std::string content_of(const Result<Message>& message) {
    if (!message) return {};
    const Bytes& form = message->short_form.bytes;
    const auto& results = message->results;
    std::string out = !results.empty()       ? results.back().signature.bytes
                      : form.size() > kLeast ? form.substr(form.size() - kSignature)
                                             : std::string();
    if constexpr (std::is_same_v<Message, Baton>) {
      out += "\n" + std::to_string(epoch_of(*message));
      for (const std::uint16_t task : message->tasks) out += " " + std::to_string(task);
    }
    return out;
  }
  static std::uint64_t epoch_of(const Baton& baton) {
    if (baton.short_form.bytes.empty()) return baton.epoch;
    VarintReader reader(baton.short_form.bytes);
    reader.bytes(scheduler::RunDefinition::kTagSize);
    return reader.number();
  }

  static constexpr std::size_t kSignature = 64, kLeast = 80;  ///< of a form with a result

  std::set<std::string> seen_;
  std::string first_;
};

}  // namespace trb::world
