#include "tests/bench/fields/reader.hpp"

#include <sys/socket.h>

#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <thread>
#include <vector>

namespace trb::bench {
namespace {

constexpr std::size_t kDigits = 16;

std::uint64_t number_of(std::string_view data) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(data.data(), data.data() + std::min(kDigits, data.size()), number);
  if (data.size() != kDataSize || error != std::errc() || end != data.data() + kDigits) {
    throw std::runtime_error("data that was not sent: " + std::string(data));
  }
  return number;
}

/// The head of each message, as it must arrive.
std::array<std::string, 4> head_of(const std::string& source) {
  return {"command", "move", source, std::to_string(kDataSize)};
}

void send_all(int fd, const std::string& bytes) {
  if (::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the node does not take an acknowledgement");
  }
}

class AcknowledgingReader final : public Reader {
 public:
  AcknowledgingReader(int fd, const std::string& source) : Reader(fd), head_(head_of(source)) {}

  void read() override {
    held_ += receive();
    std::string answer;
    std::size_t begin = 0;
    for (std::size_t end; (end = held_.find('\n', begin)) != std::string::npos; begin = end + 1) {
      take(std::string_view(held_).substr(begin, end - begin));
      answer += "ok\n";
    }
    held_.erase(0, begin);
    if (!answer.empty()) send_all(fd_, answer);
  }

 private:
  void take(std::string_view field) {
    ++tally_.fields;
    if (place_ == head_.size()) {
      take_number(number_of(field));
      place_ = 0;
    } else if (field != head_[place_++]) {
      throw std::runtime_error("a field that was not sent there: " + std::string(field));
    }
  }

  std::array<std::string, 4> head_;
  std::string held_;
  std::size_t place_ = 0;
};

/// The whole stream shows what has come, the single reads what a robot can make of it.
class GapReader final : public Reader {
 public:
  GapReader(int fd, const std::string& source) : Reader(fd) {
    std::size_t at = 0;
    for (const std::string& field : head_of(source)) {
      whole_ += field;
      ends_.push_back(at += field.size());
    }
    ends_.push_back(at + kDataSize);
  }

  void read() override {
    const std::string bytes = receive();
    const std::size_t from = held_.size();
    held_ += bytes;
    std::size_t borders = 0;
    for (std::size_t base = 0; base < held_.size(); base += ends_.back()) {
      for (const std::size_t end : ends_) {
        // A border is detected if a read ends there.
        if (base + end > from && base + end <= held_.size()) ++borders;
      }
    }
    if (borders == 1 && ends_at_border(held_.size())) {
      ++tally_.fields;
    } else {
      tally_.concatenated += borders - (ends_at_border(held_.size()) ? 1 : 0);
    }
    while (held_.size() >= ends_.back()) take_message();
  }

 private:
  bool ends_at_border(std::size_t size) const {
    for (const std::size_t end : ends_) {
      if (size % ends_.back() == end % ends_.back()) return true;
    }
    return false;
  }

  void take_message() {
    if (held_.compare(0, whole_.size(), whole_) != 0) throw std::runtime_error("bytes that were not sent: " + held_);
    take_number(number_of(std::string_view(held_).substr(whole_.size(), kDataSize)));
    held_.erase(0, ends_.back());
  }

  std::string whole_;              ///< a message's head
  std::vector<std::size_t> ends_;  ///< of its fields, in bytes from its beginning
  std::string held_;
};

}  // namespace

void Reader::begin(Slowness slowness, std::uint64_t first_number) {
  slowness_ = slowness;
  tally_ = {};
  next_ = first_number;
}

std::string Reader::receive() {
  ++tally_.reads;
  if (slowness_.every != 0 && tally_.reads % slowness_.every == 0) be_busy();
  std::array<char, 65536> buffer;
  const ssize_t got = ::recv(fd_, buffer.data(), buffer.size(), 0);
  if (got <= 0) throw std::runtime_error("the node has closed the connection");
  return {buffer.data(), static_cast<std::size_t>(got)};
}

void Reader::be_busy() const {
  std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(slowness_.busy_ms));
}

void Reader::take_number(std::uint64_t number) {
  if (number < next_) throw std::runtime_error("a message came late, or twice");
  tally_.lost += number - next_;
  next_ = number + 1;
  ++tally_.messages;
}

std::string data_of(std::uint64_t number) {
  std::array<char, kDigits + 1> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llu", static_cast<unsigned long long>(number));
  return std::string(digits.data(), kDigits) + std::string(kDataSize - kDigits, 'x');
}

std::unique_ptr<Reader> acknowledging_reader(int fd, const std::string& source) {
  return std::make_unique<AcknowledgingReader>(fd, source);
}

std::unique_ptr<Reader> gap_reader(int fd, const std::string& source) {
  return std::make_unique<GapReader>(fd, source);
}

}  // namespace trb::bench
