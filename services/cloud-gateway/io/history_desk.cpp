#include "services/cloud-gateway/io/history_desk.hpp"

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>
#include <utility>

namespace trb::gateway {
namespace {

constexpr int kMostWaiting = 32;

}  // namespace

/// Outlives the desk in the results that are posted. Only `store` is used by the thread.
struct HistoryDesk::Work : std::enable_shared_from_this<Work> {
  Work(boost::asio::io_context& io, std::unique_ptr<HistoryStore> opened) : loop(io), store(std::move(opened)) {}

  /// `job` on the thread, what it returns on the loop. What a callback holds moves on with that, and ends there.
  template <class Job>
  void post(Job job) {
    boost::asio::post(thread, [work = shared_from_this(), job = std::move(job),
                               guard = boost::asio::make_work_guard(loop)]() mutable {
      auto then = job(*work->store);
      boost::asio::post(work->loop, [work, then = std::move(then)] {
        if (work->is_open) then();
      });
    });
  }

  boost::asio::io_context& loop;
  std::unique_ptr<HistoryStore> store;
  bool is_open = true;
  bool is_writing = false;
  int reads = 0;
  boost::asio::thread_pool thread{1};
};

HistoryDesk::HistoryDesk(boost::asio::io_context& loop, std::unique_ptr<HistoryStore> store)
    : work_(std::make_shared<Work>(loop, std::move(store))) {}

HistoryDesk::~HistoryDesk() {
  work_->is_open = false;
  work_->thread.join();
}

bool HistoryDesk::is_writing() const {
  return work_->is_writing;
}

void HistoryDesk::add(std::vector<HistoryEntry> entries, UtcTime now, Added done) {
  work_->is_writing = true;
  work_->post(
      [work = work_.get(), entries = std::move(entries), now, done = std::move(done)](HistoryStore& store) mutable {
        return [work, done = std::move(done), status = store.add(entries, now)] {
          work->is_writing = false;
          done(status);
        };
      });
}

void HistoryDesk::find(HistoryQuery query, Found found) {
  if (work_->reads == kMostWaiting)
    return found(fail(Errc::queue_full, "too many histories are being read", "try again in a second"))();
  ++work_->reads;
  work_->post([work = work_.get(), query = std::move(query), found = std::move(found)](HistoryStore& store) mutable {
    std::function<void()> then = found(store.find(query));
    return [work, found = std::move(found), then = std::move(then)] {
      --work->reads;
      then();
    };
  });
}

}  // namespace trb::gateway
