// One client: its position in each of its topics, and at most one frame that it has not taken yet.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "services/cloud-gateway/core/live/block_maker.hpp"
#include "services/cloud-gateway/core/live/message_lane.hpp"

namespace trb::gateway {

/// Why a topic restarts.
enum class NoticeKind : std::uint8_t { dropped = 0, too_old, restarted };
constexpr auto enum_names(NoticeKind) {
  return std::array<std::string_view, 3>{"dropped", "too_old", "restarted"};
}

struct Notice {
  NoticeKind kind{};
  Topic topic;
  bool operator==(const Notice&) const = default;
};

struct Frame {
  std::uint64_t count = 0;  ///< for this client: 1, 2, 3 ...
  /// The client knows every topic up to it, except those whose block has `more`. If a topic had no room: what it was
  /// in the last frame that had them all.
  std::uint64_t head = 0;
  UtcTime time;
  RowSources silent;  ///< when it was made; without a row of theirs nobody knows whether there is nothing
  std::vector<Notice> notices;
  std::vector<SharedBlock> blocks;
  std::vector<SharedBytes> messages;
  std::uint64_t left_out = 0;  ///< messages missing before these
  std::size_t size = 0;        ///< approximate, in bytes
  [[nodiscard]] bool is_empty() const { return notices.empty() && blocks.empty() && messages.empty() && left_out == 0; }
};

/// The position of a client when its connection was lost.
struct Resume {
  std::uint64_t instance = 0;
  std::uint64_t number = 0;
};

class ClientFeed {
 public:
  static constexpr std::size_t kMaxTopics = 64;
  static constexpr std::size_t kMaxQueue = 1U << 20U;
  static constexpr std::size_t kMaxFrame = kMaxQueue;       ///< or one larger block: what waits is within its bound
  static constexpr std::size_t kMaxMessages = 512U << 10U;  ///< of messages in a frame
  static constexpr Duration kQuiet = std::chrono::seconds(1);
  static constexpr Duration kStalled = std::chrono::seconds(10);

  /// No effect on a topic that is already subscribed. Errors: queue_full.
  Status subscribe(const Topic& topic, std::uint64_t from, std::optional<NoticeKind> notice);
  void unsubscribe(const Topic& topic);
  /// Makes a frame if there is news and the last frame was taken. True: there is a new frame to take.
  bool pump(BlockMaker& blocks, const MessageLane& lane, const RowSources& silent, Now now);
  std::optional<Frame> take();
  /// More can be sent at once.
  [[nodiscard]] bool is_behind() const { return behind_; }
  /// Its last frame was not taken for so long that nobody can be looking.
  [[nodiscard]] bool is_stalled(Now now) const { return waiting_ && made_at_ && now.mono - *made_at_ >= kStalled; }
  [[nodiscard]] bool has(TopicKind kind) const;
  [[nodiscard]] std::vector<Topic> topics() const;

 private:
  struct Seen {
    std::uint64_t from = 0;
    bool is_snapshot = true;
  };
  void restart(Seen& seen, const Topic& topic, NoticeKind kind);
  void fill_blocks(Frame& frame, BlockMaker& blocks);
  void fill_block(Frame& frame, const Topic& topic, Seen& seen, BlockMaker& blocks);
  [[nodiscard]] bool is_whole(const Frame& frame) const;
  void fill_messages(Frame& frame, const MessageLane& lane);
  void drop_if_full(BlockMaker& blocks, Now now);

  std::map<Topic, Seen> topics_;
  std::vector<Notice> notices_;  ///< of its topics: one each while no frame was made
  std::optional<Frame> waiting_;
  std::optional<Topic> next_;           ///< the first topic that the last frame had no room for
  std::optional<std::uint64_t> known_;  ///< up to it the client has every topic; none: it has begun with nothing
  bool whole_ = false;                  ///< once it has taken the frame that waits, it has every topic up to its head
  std::uint64_t left_out_ = 0;          ///< messages of a frame that was dropped
  std::uint64_t count_ = 0;
  std::optional<MonotonicTime> made_at_;
  MonotonicTime looked_at_;
  bool behind_ = false;
  bool skipped_ = false;  ///< the last frame was not taken when the next one was due
};

}  // namespace trb::gateway
