#include "tests/bench/gateway/pages.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <charconv>
#include <cstdio>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace trb::bench {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Problem = boost::system::error_code;
using Tls = beast::ssl_stream<tcp::socket>;

constexpr std::size_t kMaxMessage = 4U << 20U;

/// The monotonic clock of the feeder.
std::int64_t now_us() {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000 + time.tv_nsec / 1000;
}

/// Times in steps of 0.1 ms, up to 20 s.
class Histogram {
 public:
  void add(std::int64_t us) {
    const auto at = static_cast<std::size_t>(std::max<std::int64_t>(us, 0) / kStep_us);
    ++counts_[std::min(at, counts_.size() - 1)];
    ++size_;
    most_us_ = std::max(most_us_, us);
  }
  [[nodiscard]] double share_ms(double share) const {
    std::uint64_t behind = static_cast<std::uint64_t>(static_cast<double>(size_) * share);
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      if (counts_[i] > behind) return static_cast<double>((i + 1) * kStep_us) / 1000;
      behind -= counts_[i];
    }
    return most_ms();
  }
  [[nodiscard]] double most_ms() const { return static_cast<double>(most_us_) / 1000; }
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  static constexpr std::int64_t kStep_us = 100;
  std::vector<std::uint64_t> counts_ = std::vector<std::uint64_t>(200'000);
  std::uint64_t size_ = 0;
  std::int64_t most_us_ = 0;
};

struct Found {
  Histogram times;  ///< of every change: from when it was due until a page has read it, or a newer one of that robot
  std::uint64_t rows = 0;
  std::uint64_t frames = 0;
  std::uint64_t bytes = 0;
  std::uint64_t notices = 0;
  bool is_measuring = false;
};

class Page : public std::enable_shared_from_this<Page> {
 public:
  Page(asio::io_context& loop, asio::ssl::context& tls, const PagesSettings& settings, Found& found, bool stalls)
      : stream_(loop, tls),
        settings_(settings),
        found_(found),
        stalls_(stalls),
        seen_(static_cast<std::size_t>(settings.robots)) {}

  void open() {
    beast::get_lowest_layer(stream_).connect({asio::ip::address_v4::loopback(), settings_.port});
    beast::get_lowest_layer(stream_).set_option(tcp::no_delay(true));
    stream_.next_layer().set_verify_callback(asio::ssl::host_name_verification("localhost"));
    stream_.next_layer().handshake(asio::ssl::stream_base::client);
    stream_.set_option(websocket::stream_base::decorator([this](websocket::request_type& request) {
      request.set(beast::http::field::authorization, "Bearer " + settings_.token);
    }));
    stream_.read_message_max(kMaxMessage);
    stream_.handshake("localhost:" + std::to_string(settings_.port), "/api/v1/live");
    for (const char* topic : {"fleet", "alerts", "teleop"}) {
      stream_.write(asio::buffer(R"({"subscribe": ")" + std::string(topic) + "\"}"));
    }
    if (!stalls_) read();
  }
  [[nodiscard]] bool is_served() const { return stalls_ || (!is_closed_ && robots_ == seen_.size()); }

 private:
  void read() {
    stream_.async_read(message_, [self = shared_from_this()](Problem problem, std::size_t) { self->on_read(problem); });
  }

  void on_read(Problem problem) {
    if (problem) {
      is_closed_ = true;
      return;
    }
    const auto data = message_.data();
    take({static_cast<const char*>(data.data()), data.size()}, now_us());
    message_.consume(message_.size());
    read();
  }

  /// A row of a robot has "value":"ROBOT NUMBER DUE" of its value "said".
  void take(std::string_view text, std::int64_t now) {
    constexpr std::string_view kSaid = R"("name":"said","value":")";
    ++found_.frames;
    found_.bytes += text.size();
    if (text.substr(0, 400).find(R"("notices":[])") == std::string_view::npos) ++found_.notices;
    for (std::size_t at = 0; (at = text.find(kSaid, at)) != std::string_view::npos;) {
      at += kSaid.size();
      std::int64_t words[3] = {};
      const char* from = text.data() + at;
      for (std::int64_t& word : words) from = std::from_chars(from, text.data() + text.size(), word).ptr + 1;
      on_change(static_cast<std::size_t>(words[0]), words[1], words[2], now);
    }
  }

  void on_change(std::size_t robot, std::int64_t number, std::int64_t due_us, std::int64_t now) {
    if (robot >= seen_.size()) return;
    std::int64_t& last = seen_[robot];
    if (last == 0) ++robots_;
    ++found_.rows;
    // Changes that a newer one has replaced have waited longer.
    const double between_us = 1e6 / settings_.changes;
    for (std::int64_t one = last + 1; found_.is_measuring && last > 0 && one <= number; ++one) {
      found_.times.add(now - due_us + static_cast<std::int64_t>(static_cast<double>(number - one) * between_us));
    }
    last = std::max(last, number);
  }

  websocket::stream<Tls, false> stream_;
  const PagesSettings& settings_;
  Found& found_;
  bool stalls_;
  bool is_closed_ = false;
  beast::flat_buffer message_;
  std::vector<std::int64_t> seen_;  ///< the number of each robot's last change
  std::size_t robots_ = 0;          ///< of which something has come
};

void print(const PagesSettings& settings, const Found& found, double cpu_s) {
  const double pages = settings.pages - settings.stalled;
  std::printf(
      R"({"p50_ms": %.1f, "p99_ms": %.1f, "most_ms": %.1f, "changes": %llu, "rows": %llu, "frames_per_s": %.2f, )"
      R"("kB_per_s": %.0f, "notices": %llu, "own_cores": %.2f})"
      "\n",
      found.times.share_ms(0.5), found.times.share_ms(0.99), found.times.most_ms(),
      static_cast<unsigned long long>(found.times.size()), static_cast<unsigned long long>(found.rows),
      static_cast<double>(found.frames) / pages / settings.seconds,
      static_cast<double>(found.bytes) / 1000 / pages / settings.seconds,
      static_cast<unsigned long long>(found.notices), cpu_s / settings.seconds);
  std::fflush(stdout);
}

}  // namespace

bool watch_as_pages(const PagesSettings& settings) {
  asio::io_context loop;
  asio::ssl::context tls(asio::ssl::context::tls_client);
  tls.load_verify_file(settings.certificate_file);
  tls.set_verify_mode(asio::ssl::verify_peer);
  Found found;
  std::vector<std::shared_ptr<Page>> pages;
  for (int i = 0; i < settings.pages; ++i) {
    pages.push_back(std::make_shared<Page>(loop, tls, settings, found, i < settings.stalled));
    pages.back()->open();
    loop.poll();
  }
  const auto run_for = [&](double seconds) {
    loop.restart();
    loop.run_for(std::chrono::microseconds(static_cast<std::int64_t>(seconds * 1e6)));
  };
  run_for(settings.warm_s);
  const auto served = [&] {
    return std::ranges::all_of(pages, [](const std::shared_ptr<Page>& page) { return page->is_served(); });
  };
  if (!served()) return std::fputs("not every page has every robot after the warm-up\n", stderr), false;
  found = {};
  found.is_measuring = true;
  std::puts("measuring");
  std::fflush(stdout);
  const std::clock_t begin = std::clock();
  run_for(settings.seconds);
  print(settings, found, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  if (!served()) return std::fputs("the gateway has closed a page that reads\n", stderr), false;
  return true;
}

}  // namespace trb::bench
