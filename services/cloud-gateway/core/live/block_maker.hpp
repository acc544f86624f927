// The rows of a topic that a client lacks, made once for all clients at the same position.
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
  bool begins = false;  ///< a snapshot begins: the client forgets its rows of this topic
  bool is_snapshot = false;
  bool more = false;     ///< further blocks follow; false: the topic is complete
  std::uint64_t to = 0;  ///< the client then knows the topic up to this number
  std::vector<SharedBytes> rows;
  std::size_t size = 0;        ///< of all rows
  mutable SharedBytes joined;  ///< for the shell: the encoded block, kept when it is first sent
};
using SharedBlock = std::shared_ptr<const Block>;

class BlockMaker {
 public:
  static constexpr std::size_t kMaxBlock = 768U << 10U;  ///< or one larger row

  /// Both must outlive it.
  BlockMaker(const RowBook& book, RowEncoder& encoder) : book_(book), encoder_(encoder) {}

  /// The rows after `from`; nullptr: none, and no snapshot, which is sent even if empty.
  SharedBlock block(const Topic& topic, std::uint64_t from, bool is_snapshot);
  /// The size of all rows after `from`, in bytes; stops counting at `enough`.
  std::size_t waiting(const Topic& topic, std::uint64_t from, std::size_t enough);
  /// The changes after `from` are incomplete: a removal was already forgotten.
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
  std::uint64_t made_at_ = 0;  ///< the head for which `made_` is valid
  std::uint64_t encoded_ = 0;
};

}  // namespace trb::gateway
