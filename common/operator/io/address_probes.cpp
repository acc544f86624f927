#include "common/operator/io/address_probes.hpp"

#include <algorithm>
#include <utility>

#include "common/operator/io/probe_attempts.hpp"

namespace trb::op {

/// The addresses of one call, and what is tried on each.
class AddressProbes::Batch {
 public:
  explicit Batch(Loop& loop) : loop_(loop) {}
  ~Batch() { drop(); }
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;

  using Try = std::unique_ptr<Attempt> (*)(const std::string& address, MonotonicTime now);
  void begin(std::vector<AddressProbe> addresses, Try attempt, Done done) {
    addresses_ = std::move(addresses);
    done_ = std::move(done);
    const MonotonicTime now = read_clocks().mono;
    for (const AddressProbe& probe : addresses_) attempts_.push_back(attempt(probe.address, now));
    for (const auto& each : attempts_) {
      if (!each->done()) watch(*each);
    }
  }

  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const {
    if (!done_) return std::nullopt;
    std::optional<MonotonicTime> next;
    for (const auto& each : attempts_) {
      if (!each->done()) next = earlier(next, each->deadline());
    }
    return next.value_or(MonotonicTime{0});
  }

  void tick(MonotonicTime now) {
    for (const auto& each : attempts_) {
      if (each->done() || each->deadline() > now) continue;
      each->on_late(now);
      if (each->done()) loop_.remove_fd(each->fd());
    }
    if (std::ranges::all_of(attempts_, [](const auto& each) { return each->done(); })) finish();
  }

 private:
  void watch(Attempt& attempt) {
    loop_.add_fd(attempt.fd(), attempt.events(), [this, &attempt](short) { on_ready(attempt); });
  }

  void on_ready(Attempt& attempt) {
    const short before = attempt.events();
    attempt.on_ready(read_clocks().mono);
    if (attempt.done()) return loop_.remove_fd(attempt.fd());
    if (attempt.events() != before) watch(attempt);
  }

  void finish() {
    for (std::size_t i = 0; i < attempts_.size(); ++i) attempts_[i]->write_result(addresses_[i]);
    drop();
    // The callback may begin the next call.
    std::exchange(done_, nullptr)(std::move(addresses_));
  }

  void drop() {
    for (const auto& each : attempts_) {
      if (!each->done()) loop_.remove_fd(each->fd());
    }
    attempts_.clear();
  }

  Loop& loop_;
  std::vector<AddressProbe> addresses_;
  std::vector<std::unique_ptr<Attempt>> attempts_;  ///< by the addresses' places
  Done done_;                                       ///< empty: no call is in progress
};

AddressProbes::AddressProbes(Loop& loop) : batch_(std::make_shared<Batch>(loop)) {
  // A loop's timer cannot be removed.
  loop.add_timer(
      [weak = std::weak_ptr(batch_)] {
        const auto batch = weak.lock();
        return batch ? batch->next_deadline() : std::nullopt;
      },
      [weak = std::weak_ptr(batch_)](Now now) {
        if (const auto batch = weak.lock()) batch->tick(now.mono);
      });
}

AddressProbes::~AddressProbes() = default;

void AddressProbes::try_ports(std::vector<AddressProbe> addresses, Done done) {
  batch_->begin(std::move(addresses), try_connection, std::move(done));
}

void AddressProbes::try_datagrams(std::vector<AddressProbe> addresses, Done done) {
  batch_->begin(std::move(addresses), op::try_datagrams, std::move(done));
}

}  // namespace trb::op
