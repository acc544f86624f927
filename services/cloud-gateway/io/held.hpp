// What a file without room does not take for now, and nobody has to wait for.
#pragma once

#include "services/cloud-gateway/io/store/gateway_db.hpp"

namespace trb::gateway {

/// Who is signed in, answers of requests, signed heads: memory has them, and a kill meanwhile costs no more than that.
class Held {
 public:
  /// How much of a batch may wait besides.
  enum class Besides : std::uint8_t {
    nothing,
    alarms,  ///< what nobody decides comes of itself: acknowledgements that end, shelves
    moved,   ///< the clock has stepped: tokens, too
  };

  /// Takes from the batch what may wait, the newest of each key. What is left was refused.
  void take_from(StoreBatch& batch, Besides besides);
  /// What waits, and the batch behind it.
  [[nodiscard]] StoreBatch before(const StoreBatch& batch) const;
  [[nodiscard]] const std::vector<Change<Session>>& sessions() const { return waits_.sessions; }
  void clear() { waits_ = {}; }

 private:
  StoreBatch waits_;
};

}  // namespace trb::gateway
