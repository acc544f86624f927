#include "services/virtual-robots/mir/virtual_mir.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::mir {

namespace http = boost::beast::http;

struct VirtualMir::Intake {
  std::unique_ptr<http::request_parser<http::string_body>> parser;

  Intake() { restart(); }
  void restart() {
    parser = std::make_unique<http::request_parser<http::string_body>>();
    parser->eager(true);
    parser->body_limit(65536);
  }
};

VirtualMir::VirtualMir(const Settings& settings)
    : clock_(settings.speed),
      robot_(settings.robot),
      rest_(robot_, settings.user.empty() ? "" : authorization_of(settings.user, settings.password)),
      server_(settings.where, 16),
      console_(settings.control) {}

VirtualMir::~VirtualMir() = default;

void VirtualMir::run(const Fd& end) {
  console_.announce(std::to_string(server_.port()));
  for (;;) {
    std::vector<pollfd> polled = console_.to_poll(end);
    server_.add_to_poll(polled);
    if (!Console::wait(polled, clock_.deadline(robot_.next_deadline()))) return;
    robot_.advance(clock_.now());
    server_.serve(polled, [this](TcpServer::Client& client) { take(client); });
    std::erase_if(intakes_, [this](const auto& one) { return server_.find(one.first) == nullptr; });
    for (const std::string& line : console_.read(polled)) take_line(line);
    robot_.advance(clock_.now());
    for (const std::string& event : robot_.take_events()) print_line(event);
    flush_lines();
  }
}

void VirtualMir::take(TcpServer::Client& client) {
  auto& intake = intakes_[client.id];
  if (!intake) intake = std::make_unique<Intake>();
  while (!client.input.empty()) {
    auto& parser = *intake->parser;
    boost::system::error_code problem;
    const std::size_t taken = parser.put(boost::asio::buffer(client.input.data(), client.input.size()), problem);
    client.input.erase(0, taken);
    if (problem && problem != http::error::need_more) return client.drop("no_http");
    if (!parser.is_done()) {
      if (taken == 0 || problem) return;
      continue;
    }
    const auto& request = parser.get();
    const bool stays = parser.keep_alive();
    const Answer answer = rest_.answer(std::string(request.method_string()), std::string(request.target()),
                                       std::string(request[http::field::authorization]), request.body());
    http::status_class const of = http::to_status_class(answer.status);
    std::string head = "HTTP/1.1 " + std::to_string(answer.status) + " " +
                       std::string(http::obsolete_reason(http::int_to_status(answer.status))) + "\r\n";
    if (!answer.body.empty()) head += "Content-Type: application/json\r\n";
    if (answer.status != 204) head += "Content-Length: " + std::to_string(answer.body.size()) + "\r\n";
    server_.send(client, head + (stays ? "" : "Connection: close\r\n") + "\r\n" + answer.body);
    if (of != http::status_class::successful) print_line("refused " + std::to_string(answer.status));
    intake->restart();
    if (!stays) return client.drop("closed");
  }
}

void VirtualMir::take_line(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  const auto fault = order == "fault" ? parse_fault_order(words) : std::nullopt;
  if (line == "estop" || (fault && fault->severity == "FATAL")) {
    robot_.emergency_stop();
  } else if (fault) {
    robot_.fail({fault->severity == "CRITICAL" ? 10104 : 10107, fault->text.empty() ? "Motor fault" : fault->text,
                 fault->severity == "CRITICAL"});
  } else if (line == "clear") {
    robot_.end_emergency();
    robot_.clear_errors();
  } else {
    print_line("unknown_line");
  }
}

}  // namespace trb::virtual_robots::mir
