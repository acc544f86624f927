// A robot that reads fields at a given slowness, and counts the messages that it can decode.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace trb::bench {

/// After `every` reads it is busy for this long; 0 reads: never.
struct Slowness {
  double busy_ms = 0;
  std::uint64_t every = 0;
};

struct Tally {
  std::uint64_t messages = 0;  ///< whole, in their order, with their own data
  std::uint64_t lost = 0;      ///< numbers that were skipped
  std::uint64_t reads = 0;
  std::uint64_t fields = 0;        ///< that came alone
  std::uint64_t concatenated = 0;  ///< borders between two fields that were not detected
};

class Reader {
 public:
  Reader() = default;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  virtual ~Reader() = default;

  /// Reads once what is there; acknowledges what it must. Throws if the connection or the stream is unusable.
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
/// Framing "delay", as in the paper: the result of one read counts as a field.
std::unique_ptr<Reader> gap_reader(int fd, const std::string& source);

}  // namespace trb::bench
