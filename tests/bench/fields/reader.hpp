// A robot that reads fields, as slowly as it is told to, and counts what it can make of them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace trb::bench {

/// How slow: after every so many reads it does something else for so long; 0 reads: never.
struct Slowness {
  double busy_ms = 0;
  std::uint64_t every = 0;
};

struct Tally {
  std::uint64_t messages = 0;  ///< whole, in their order, with their own data
  std::uint64_t lost = 0;      ///< numbers that were passed over
  std::uint64_t reads = 0;
  std::uint64_t fields = 0;        ///< that came alone
  std::uint64_t concatenated = 0;  ///< borders between two fields that were not seen
};

class Reader {
 public:
  Reader() = default;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  virtual ~Reader() = default;

  /// Reads once what is there; acknowledges what it must. Throws if the connection or the stream is of no use any more.
  virtual void read() = 0;
  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] const Tally& tally() const { return tally_; }
  void begin(Slowness slowness, std::uint64_t first_number);

 protected:
  explicit Reader(int fd) : fd_(fd) {}
  std::string receive();
  void take_number(std::uint64_t number);

  int fd_;
  Tally tally_;

 private:
  void be_busy() const;

  Slowness slowness_;
  std::uint64_t next_ = 0;
};

constexpr std::size_t kDataSize = 48;
/// The data of the message of that number.
std::string data_of(std::uint64_t number);

/// Framing "newline": a field is a line, each is acknowledged, and each must be the one that it should be.
std::unique_ptr<Reader> acknowledging_reader(int fd, const std::string& source);
/// Framing "delay", as in the paper: whatever one read gives is taken for a field.
std::unique_ptr<Reader> gap_reader(int fd, const std::string& source);

}  // namespace trb::bench
