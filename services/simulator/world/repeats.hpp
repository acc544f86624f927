// Whether anything that was owed was sent again: while nothing fails, nobody has to.
#pragma once

#include <set>
#include <string>

#include "proto/bodies/run.hpp"
#include "proto/message.hpp"
#include "services/simulator/world/meter.hpp"

namespace trb::world {

class Repeats {
 public:
  void on(const Sending& sending, std::string_view frame) {
    const bool owed = sending.subtype == Baton::kSubtype || sending.subtype == Results::kSubtype;
    if (!owed || !sending.between_computers) return;
    const auto header = decode_frame(frame);
    if (!header) return;
    const std::string what = std::string(sending.from) + "\n" + std::string(sending.to) + "\n" +
                             std::string(sending.subtype) + std::string(header->data);
    if (!seen_.insert(what).second && first_.empty())
      first_ = std::string(sending.from) + " has sent " + std::string(sending.to) + " the same " +
               std::string(sending.subtype) + " again";
  }
  /// Empty: nothing was.
  [[nodiscard]] const std::string& first() const { return first_; }

 private:
  std::set<std::string> seen_;
  std::string first_;
};

}  // namespace trb::world
