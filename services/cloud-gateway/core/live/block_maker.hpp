// What a client lacks of a topic, made once for all who stand at the same number of it.
#pragma once

#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "services/cloud-gateway/core/live/row_book.hpp"
#include "services/cloud-gateway/core/live/topic.hpp"

namespace trb::gateway {

struct Block {
  Topic topic;
  bool begins = false;  ///< a snapshot begins: what was known of the topic is to be forgotten
  bool is_snapshot = false;
  bool more = false;     ///< further blocks follow; what is shown is whole without
  std::uint64_t to = 0;  ///< the topic is known up to this number
  std::vector<SharedBytes> rows;
  std::size_t size = 0;        ///< of all rows
  mutable SharedBytes joined;  ///< of io: the block as it goes out, made by the first client that is sent it
};
using SharedBlock = std::shared_ptr<const Block>;

class BlockMaker {
 public:
  static constexpr std::size_t kMaxBlock = 256U << 10U;  ///< or one row that is larger

  /// Both outlive it.
  BlockMaker(const RowBook& book, RowEncoder& encoder) : book_(book), encoder_(encoder) {}

  /// What stands behind `from`; nullptr: nothing, and it is no snapshot that has to say so.
  SharedBlock block(const Topic& topic, std::uint64_t from, bool is_snapshot);
  /// How many bytes stand behind `from`; counts no further than `enough`.
  std::size_t waiting(const Topic& topic, std::uint64_t from, std::size_t enough);
  /// What is behind `from` can no longer be told in full: a removal is forgotten.
  [[nodiscard]] bool is_too_old(const Topic& topic, std::uint64_t from) const;
  [[nodiscard]] const RowBook& book() const { return book_; }
  /// How often a row was encoded.
  [[nodiscard]] std::uint64_t encoded() const { return encoded_; }

 private:
  template <class Visit>
  void each_behind(const Topic& topic, std::uint64_t from, Visit visit) const;
  SharedBlock make(const Topic& topic, std::uint64_t from, bool is_snapshot);
  const SharedBytes& bytes_of(const Row& row);

  const RowBook& book_;
  RowEncoder& encoder_;
  std::map<std::tuple<Topic, std::uint64_t, bool>, SharedBlock> made_;
  std::uint64_t made_at_ = 0;  ///< the head that they belong to
  std::uint64_t encoded_ = 0;
};

}  // namespace trb::gateway
