// Streams: requesters that get a value of the robot's again and again, as information of the request's subtype.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "services/mode-adapter/core/drivers.hpp"

namespace trb::adapter {

/// The stream that a request's data asks for besides its answer: `{"stream_s": 10, "every_s": 0.5}`.
struct StreamOrder {
  double for_s = 0;    ///< 0: ends a running stream
  double every_s = 0;  ///< the shortest time between two messages
};

/// None if the data asks for no stream. Errors: bad_value, naming the key.
Result<std::optional<StreamOrder>> read_stream_order(BytesView data);

class Streams {
 public:
  /// One for each requester and subtype: a repeated request renews it. If there is no place, who has the most gives
  /// way. Errors: queue_full.
  Status add(std::string_view subtype, std::string_view source, Driver& mode, const StreamOrder& order, Now now);

  /// Sends each stream the values that the mode has received since the stream's last one.
  void on_values(Driver& mode, Now now, Outbox& out);
  void on_link_down(const Driver& mode);
  /// The subtypes whose last stream has ended since the last call.
  std::vector<std::string> take_ended(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Stream {
    std::string subtype;
    std::string source;
    Driver* mode = nullptr;
    Duration every{};
    MonotonicTime until;
    MonotonicTime next;
    MonotonicTime told;  ///< when the value that was sent last had been received
  };
  bool make_room(std::string_view source);
  void drop(const std::function<bool(const Stream&)>& is_over);

  std::vector<Stream> streams_;
  std::vector<std::string> ended_;
};

}  // namespace trb::adapter
