// Requests that go on: who is told a value of the robot's again and again, as information of the request's subtype.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "services/mode-adapter/core/drivers.hpp"

namespace trb::adapter {

/// What a request's data asks for besides its answer: `{"stream_s": 10, "every_s": 0.5}`.
struct StreamOrder {
  double for_s = 0;    ///< 0: a stream that goes on is ended
  double every_s = 0;  ///< at most so often
};

/// None if the data asks for no stream. Errors: bad_value, naming the key.
Result<std::optional<StreamOrder>> read_stream_order(BytesView data);

class Streams {
 public:
  /// One for each requester and subtype: asked for again, it is renewed. Errors: queue_full.
  Status add(std::string_view subtype, std::string_view source, Driver& mode, const StreamOrder& order, Now now);

  /// Tells what that mode has heard since each was told last.
  void on_values(Driver& mode, Now now, Outbox& out);
  void on_link_down(const Driver& mode);
  /// The subtypes that nobody is told any more since the last call.
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
    MonotonicTime told;  ///< when the value that was told last was heard
  };
  void drop(const std::function<bool(const Stream&)>& is_over);

  std::vector<Stream> streams_;
  std::vector<std::string> ended_;
};

}  // namespace trb::adapter
