// The direct mode over HTTP: a command is one or more requests with JSON, values are polled in rounds. Only one request
// is in progress at a time, so that a stop waits for one answer at most.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/drivers/http-json/commands.hpp"
#include "common/drivers/http-json/poll.hpp"
#include "common/drivers/http-json/session.hpp"
#include "common/drivers/http-json/wire.hpp"
#include "common/drivers/polled_driver.hpp"

namespace trb::drivers {

/// With its placeholders filled.
struct HttpStep {
  HttpCall words;
  HttpPath path;
  std::string body;

  [[nodiscard]] bool always() const { return words.always; }
};

/// event               | nothing under way        | a command's request        | a value's
/// --------------------|--------------------------|----------------------------|---------------------------
/// answer 2xx          | counted, ignored         | the next one, or done      | the value
/// 401, asks anew      | -                        | sent again                 | sent again
/// another answer      | counted, ignored         | Refused, with its words    | why the value is not told
/// no answer in time   | -                        | as the connection's end    | the connection is closed
/// connection ends     | dialled again, and said  | Refused: nobody knows      | asked for again
///                     | only if that takes long  | whether it was taken; a    |
///                     |                          | stop, a release go again   |
/// halt answered       | -                        | held, then the release     | -
/// stop                | at once                  | behind that one answer     | behind that one answer
class HttpJsonDriver : public PolledDriver<std::vector<HttpCall>, HttpStep, HttpPoll> {
 public:
  HttpJsonDriver(const DriverSettings& settings, HttpCommands commands);

  /// Connections come and go with HTTP: the robot is online if it has answered, until no connection can be made for
  /// long, or none of them brings an answer. One that refuses the sign-in for a whole round of polls is not online.
  [[nodiscard]] bool online() const override { return heard_; }
  /// An answer to each request of a halt, on one of three connections, and to the request that is under way; then the
  /// halt is held.
  [[nodiscard]] Duration silence_bound() const override {
    return kMostRequests * session_.requests_for_one() * timeout_ + halt_time();
  }

  void on_up(Channel channel, Now now, const DriverOut& out) override;
  void on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) override;
  void on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) override;
  void leave(Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  static constexpr int kMostRequests = 10;
  static constexpr std::size_t kMostUnanswered = 3;  ///< requests in a row: then the robot counts as gone

  Result<std::vector<HttpStep>> fill(std::string_view subtype, BytesView data) const override;
  void pump(Now now, const DriverOut& out) override;
  [[nodiscard]] bool takes_orders() const override { return heard_; }
  void begin_step(Now now, const DriverOut& out);
  void send(const HttpRequest& request, Awaits whose, Now now, const DriverOut& out);
  void on_answer(const HttpAnswer& answer, Now now, const DriverOut& out);
  void on_poll(const HttpAnswer& answer, Now now, const DriverOut& out);
  void end_connection(Now now, const DriverOut& out);
  void look_at_link(Awaits whose, const HttpAnswer& answer, const DriverOut& out);
  void refuse_all(const Error& reason, const DriverOut& out);
  [[nodiscard]] Error offline_error() const override;
  void on_step(const HttpAnswer& answer, Now now, const DriverOut& out);
  Status remember(const HttpCall& words, const HttpAnswer& answer);
  void on_done(const Job& job, Now now, const DriverOut& out) override;
  void on_lost_job(const std::string& reason, Now now, const DriverOut& out);
  void on_unanswered(const std::string& reason, Now now, const DriverOut& out);
  void go_offline(const std::string& reason, const DriverOut& out);

  HttpSession session_;
  HttpBody body_;
  std::optional<HttpCall> sign_out_;
  Duration timeout_;

  MonotonicTime sent_at_{};
  std::optional<MonotonicTime> lost_at_;  ///< the last connection's end, until there is another one
  std::string lost_why_;
  std::size_t sign_ins_refused_ = 0;  ///< polls in a row
  Error refused_why_;           ///< what answers is not the robot, or does not accept this node's user; ok: it does
  std::size_t unanswered_ = 0;  ///< requests in a row whose connection ended before the answer
  MonotonicTime unanswered_since_{};  ///< when the first of them did
  Remembered remembered_;
  HttpReader reader_;
};

}  // namespace trb::drivers
