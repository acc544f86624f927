#include "tests/bench/road/drive.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace trb::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kDataSize = 48;
constexpr std::size_t kDigits = 16;
constexpr std::chrono::milliseconds kPatience{2000};

/// 48 bytes of text: a number, then padding.
Frame message_of(std::uint64_t number) {
  Frame frame(kDataSize);
  std::array<char, kDigits + 1> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llu", static_cast<unsigned long long>(number));
  char* data = static_cast<char*>(frame.data());
  std::copy_n(digits.data(), kDigits, data);
  std::fill(data + kDigits, data + kDataSize, 'x');
  return frame;
}

std::uint64_t number_of(const Frame& frame) {
  const BytesView text = view_of(frame);
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + std::min(kDigits, text.size()), number);
  if (text.size() != kDataSize || error != std::errc() || end != text.data() + kDigits) {
    throw std::runtime_error("a message came that was not sent: " + std::string(text));
  }
  return number;
}

class Driver {
 public:
  Driver(End& out, End& in) : out_(out), in_(in) {}

  void latency(std::size_t count) {
    std::vector<double> times;
    times.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto begin = Clock::now();
      send();
      out_.flush();
      while (!take()) wait();
      times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
    }
    std::sort(times.begin(), times.end());
    const auto at = [&](double part) { return times[static_cast<std::size_t>(part * static_cast<double>(count - 1))]; };
    std::printf("{\"messages\":%zu,\"min_us\":%.2f,\"median_us\":%.2f,\"p99_us\":%.2f}\n", count, at(0), at(0.5),
                at(0.99));
  }

  void throughput(double seconds, std::uint64_t window) {
    const std::uint64_t first = sent_;
    heard_ = 0;
    const auto begin = Clock::now();
    const auto end = begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    while (Clock::now() < end) {
      while (sent_ - next_ < window) send();
      out_.flush();
      if (!take_all()) wait();
    }
    const double took = std::chrono::duration<double>(Clock::now() - begin).count();
    const double rate = static_cast<double>(heard_) / took;
    while (next_ < sent_ && (take_all() || in_.wait(kPatience))) {
    }
    next_ = sent_;
    std::printf("{\"messages\":%llu,\"per_second\":%.0f,\"lost\":%llu}\n", static_cast<unsigned long long>(heard_),
                rate, static_cast<unsigned long long>(sent_ - first - heard_));
  }

 private:
  void send() { out_.send(message_of(sent_++)); }

  /// Receives one message. Missing ones before it are lost: a road keeps the order.
  bool take() {
    if (!in_.receive(frame_)) return false;
    const std::uint64_t number = number_of(frame_);
    if (number < next_ || number >= sent_) throw std::runtime_error("a message came late, or twice");
    next_ = number + 1;
    ++heard_;
    return true;
  }

  bool take_all() {
    bool any = false;
    while (take()) any = true;
    return any;
  }

  void wait() {
    if (!in_.wait(kPatience)) throw std::runtime_error("no message for 2 s");
  }

  End& out_;
  End& in_;
  Frame frame_;
  std::uint64_t sent_ = 0;
  std::uint64_t heard_ = 0;  ///< received, in order
  std::uint64_t next_ = 0;   ///< the number after the last one received
};

}  // namespace

void drive(End& out, End& in) {
  Driver driver(out, in);
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream words(line);
    std::string order;
    double amount = 0;
    std::uint64_t window = 0;
    words >> order >> amount >> window;
    if (order == "latency" && amount >= 1) {
      driver.latency(static_cast<std::size_t>(amount));
    } else if (order == "throughput" && amount > 0 && window > 0) {
      driver.throughput(amount, window);
    } else {
      throw std::runtime_error("no order: " + line);
    }
    std::fflush(stdout);
  }
}

}  // namespace trb::bench
