#include "services/cloud-gateway/io/password_pool.hpp"

#include <sodium.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "common/security/password_hash.hpp"

namespace trb::gateway {
namespace {

/// Four seconds of two threads. SignIn lets kQueuedChecks wait; the rest is for people who change passwords.
constexpr std::size_t kMostWaiting = 64;

/// Also what a move has left in the string itself.
void wipe(std::string& secret) {
  secret.resize(secret.capacity());
  sodium_memzero(secret.data(), secret.size());
  secret.clear();
}

/// A password at one place in memory, until this goes.
struct Secret {
  explicit Secret(std::string& from) : text(from) { wipe(from); }
  ~Secret() { wipe(text); }
  Secret(const Secret&) = delete;
  Secret& operator=(const Secret&) = delete;
  std::string text;
};

CheckResult check_password(const std::string& hash, const std::string& password) {
  if (!hash.starts_with(crypto_pwhash_STRPREFIX)) return CheckResult::failed;
  errno = 0;
  if (crypto_pwhash_str_verify(hash.c_str(), password.data(), password.size()) == 0) return CheckResult::right;
  // So libsodium tells a mismatch from no memory, or from a hash that it cannot read.
  return errno == EINVAL ? CheckResult::wrong : CheckResult::failed;
}

}  // namespace

/// Outlives the pool in the results that are posted.
struct PasswordPool::Work : std::enable_shared_from_this<Work> {
  using Result = std::function<void()>;  ///< called on the loop's thread
  using Job = std::function<Result()>;   ///< called on a thread of the pool
  using Guard = boost::asio::executor_work_guard<boost::asio::io_context::executor_type>;

  explicit Work(boost::asio::io_context& io) : loop(io) {}
  bool add(Job job);  ///< false: too many wait
  void run();
  void post(Result result);
  void end();

  boost::asio::io_context& loop;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::pair<Job, Guard>> jobs;
  bool is_open = true;  ///< read by results without the mutex: it is written on the loop's thread
  std::vector<std::thread> threads;
};

bool PasswordPool::Work::add(Job job) {
  {
    const std::lock_guard lock(mutex);
    if (jobs.size() >= kMostWaiting) return false;
    jobs.emplace_back(std::move(job), Guard(loop.get_executor()));
  }
  changed.notify_one();
  return true;
}

void PasswordPool::Work::run() {
  for (;;) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [this] { return !is_open || !jobs.empty(); });
    if (!is_open) return;
    auto [job, guard] = std::move(jobs.front());
    jobs.pop_front();
    lock.unlock();
    post(job());
  }
}

void PasswordPool::Work::post(Result result) {
  boost::asio::post(loop, [work = shared_from_this(), result = std::move(result)] {
    if (work->is_open) result();
  });
}

void PasswordPool::Work::end() {
  {
    const std::lock_guard lock(mutex);
    is_open = false;
    jobs.clear();
  }
  changed.notify_all();
  for (std::thread& thread : threads) thread.join();
}

PasswordPool::PasswordPool(boost::asio::io_context& loop, std::size_t threads) : work_(std::make_shared<Work>(loop)) {
  if (sodium_init() < 0) throw std::runtime_error("libsodium could not be initialised");
  for (std::size_t i = 0; i < threads; ++i) work_->threads.emplace_back([work = work_.get()] { work->run(); });
}

PasswordPool::~PasswordPool() {
  work_->end();
}

void PasswordPool::check(PasswordCheck check, std::function<void(SignInId, CheckResult)> done) {
  const auto password = std::make_shared<const Secret>(check.password);
  // `done` moves on to the result, so that what it holds ends on the loop's thread.
  const bool taken =
      work_->add([password, id = check.id, hash = std::move(check.hash), done]() mutable -> Work::Result {
        return [id, done = std::move(done), result = check_password(hash, password->text)] { done(id, result); };
      });
  if (!taken) work_->post([id = check.id, done = std::move(done)] { done(id, CheckResult::failed); });
}

void PasswordPool::hash(std::string password, std::function<void(std::string hash)> done) {
  const auto secret = std::make_shared<const Secret>(password);
  const bool taken = work_->add([secret, done]() mutable -> Work::Result {
    return [done = std::move(done), made = hash_password(secret->text)] { done(made); };
  });
  if (!taken) work_->post([done = std::move(done)] { done({}); });
}

}  // namespace trb::gateway
