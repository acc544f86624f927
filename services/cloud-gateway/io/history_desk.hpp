// The history's thread: batches are written and pages are read beside the loop, which never waits for the disk.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "services/cloud-gateway/io/store/history_store.hpp"

namespace boost::asio {
class io_context;
}

namespace trb::gateway {

class HistoryDesk {
 public:
  using Added = std::function<void(const Status&)>;
  /// Called on the history's thread: what is made of a page, which takes long for a large one. It returns what is to be
  /// done with that on the loop.
  using Found = std::function<std::function<void()>(const Result<HistoryPage>&)>;

  /// What Added does, and what Found returns, is done on the loop's thread. `loop` must outlive this.
  HistoryDesk(boost::asio::io_context& loop, std::unique_ptr<HistoryStore> store);
  HistoryDesk(const HistoryDesk&) = delete;
  HistoryDesk& operator=(const HistoryDesk&) = delete;
  /// Waits for all that was given to it; no result comes after that.
  ~HistoryDesk();

  /// One batch at a time: is_writing() until `done` is called.
  void add(std::vector<HistoryEntry> entries, UtcTime now, Added done);
  [[nodiscard]] bool is_writing() const;
  /// At most 32 wait: a further one is refused at once. Errors: those of HistoryStore::find, queue_full.
  void find(HistoryQuery query, Found found);

 private:
  struct Work;
  std::shared_ptr<Work> work_;
};

}  // namespace trb::gateway
