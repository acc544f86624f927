// One attempt of the doctor on an address: a connection, or datagrams. Each ends with a result or at its deadline.
#pragma once

#include <memory>
#include <string>

#include "common/base/descriptor.hpp"
#include "common/base/time.hpp"
#include "common/operator/doctor/diagnosis.hpp"

namespace trb::op {

class Attempt {
 public:
  virtual ~Attempt() = default;
  Attempt(const Attempt&) = delete;
  Attempt& operator=(const Attempt&) = delete;

  /// The descriptor it waits for, and until when; meaningless once it is done.
  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] short events() const { return events_; }
  [[nodiscard]] MonotonicTime deadline() const { return deadline_; }
  [[nodiscard]] bool done() const { return done_; }

  virtual void on_ready(MonotonicTime now) = 0;
  virtual void on_late(MonotonicTime now) = 0;
  /// Writes the result into `probe`.
  virtual void write_result(AddressProbe& probe) const = 0;

 protected:
  Attempt() = default;
  void open(int fd) { fd_ = Descriptor(fd); }
  void wait_for(short events, MonotonicTime deadline) {
    events_ = events;
    deadline_ = deadline;
  }
  void end() { done_ = true; }

 private:
  Descriptor fd_;
  short events_ = 0;
  MonotonicTime deadline_;
  bool done_ = false;
};

/// A connection: 1.5 s at most.
std::unique_ptr<Attempt> try_connection(const std::string& address, MonotonicTime now);
/// Two small and two large datagrams, 250 ms each: 1 s at most.
std::unique_ptr<Attempt> try_datagrams(const std::string& address, MonotonicTime now);

}  // namespace trb::op
