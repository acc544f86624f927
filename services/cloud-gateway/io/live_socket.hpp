// A client of /api/v1/live: its words in, its frames out.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "proto/value.hpp"
#include "services/cloud-gateway/core/live/drives.hpp"
#include "services/cloud-gateway/io/gateway.hpp"
#include "services/cloud-gateway/io/http/exchange.hpp"
#include "services/cloud-gateway/io/live_word.hpp"

namespace trb::gateway {

/// The client sends {"subscribe": TOPIC, "instance": N, "from": N} (the last two to resume), {"unsubscribe": TOPIC},
/// and to drive the words of drive_words.hpp. It receives {"error": PROBLEM} for a word that is wrong, {"drive": ...}
/// for what becomes of its drive, and frames:
/// {"count", "head", "instance", "time", "notices": [{"topic", "kind"}], "blocks": [{"topic", "begins", "more", "to",
/// "rows": [ROW]}], "messages": [MESSAGE], "left_out"}; with messages also "phases", how many of each have passed,
/// and with a service of this node that tells nothing "silent": [SERVICE].
///
/// -      | the socket is open   | idle
/// idle   | a frame is due       | sending
/// idle   | a wrong word         | sending (the problem)
/// idle   | news of its drive    | sending (the newest of each robot)
/// sending| all is sent          | idle; the next frame, if one is due
/// any    | session or user ends | closed, 4401
/// any    | the database is gone | closed, 1013: nobody knows any more who may see the fleet
/// any    | 20 wrong words       | closed, 1008
class LiveSocket final : public WebSocketIn, public std::enable_shared_from_this<LiveSocket> {
 public:
  /// One person, or one token, has so many: who opens more and more leaves others a place, also behind one proxy.
  static constexpr std::size_t kMostOfOne = 50;

  /// `who`: of whom the request is. Errors: queue_full (too many clients, in all or of this one).
  static Result<std::shared_ptr<LiveSocket>> open(Gateway& gateway, HttpRequest request, std::string who);
  ~LiveSocket() override;

  void on_open(std::shared_ptr<WebSocketOut> out) override;
  void on_message(BytesView text) override;
  void on_sent() override;
  void on_closed() override;

  /// A frame may be due.
  void pump();
  /// News of this client's own drive.
  void send_drive(const DriveAnswer& answer);
  /// Closes it if its session has ended, or its user may not see the fleet any more. Counts as a use of the session: a
  /// wall screen stays signed in.
  void check_rights();
  void end_without_database();

 private:
  LiveSocket(Gateway& gateway, HttpRequest request, std::string who, ClientId client);
  Status obey(const Subscribe& word);
  Status obey(const Unsubscribe& word);
  Status obey(const DriveWord& word);
  Status obey(const AskFor& word);
  Status obey(const LetGo& word);
  [[nodiscard]] Result<Driver> driver();
  void send(Bytes text);
  void refuse(const Error& error);
  void end(std::uint16_t code, const std::string& reason);

  Gateway& gateway_;
  HttpRequest request_;  ///< checked again now and then
  std::string who_;
  ClientId client_;
  std::shared_ptr<WebSocketOut> out_;
  bool sending_ = false;
  bool is_ending_ = false;
  int wrong_ = 0;
  Bytes problem_;  ///< waits until what is being sent is sent; the newest one only
  struct DriveNews {
    bool is_over = false;
    Bytes text;
  };
  std::map<std::string, DriveNews> drive_answers_;  ///< the same, by robot
};

}  // namespace trb::gateway
