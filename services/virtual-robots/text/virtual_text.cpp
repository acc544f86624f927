#include "services/virtual-robots/text/virtual_text.hpp"

#include "services/virtual-robots/support/options.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::text {
namespace {

constexpr double kSilence_s = 1;  ///< of real time

std::unique_ptr<Dialogue> make(const Settings& settings) {
  if (settings.profile == "dobot") return make_dobot();
  if (settings.profile == "crlf-login") return make_login(settings.password);
  if (settings.profile == "alive") return make_alive(kSilence_s * settings.speed);
  throw OptionError("no profile " + settings.profile + ": use dobot, crlf-login or alive");
}

}  // namespace

VirtualText::VirtualText(const Settings& settings)
    : clock_(settings.speed), robot_(make(settings)), server_(settings.where, 1), console_(settings.control) {}

void VirtualText::run(const Fd& end) {
  console_.announce(std::to_string(server_.port()));
  for (;;) {
    std::vector<pollfd> polled = console_.to_poll(end);
    server_.add_to_poll(polled);
    if (!Console::wait(polled, clock_.deadline(robot_->next_deadline()))) return;
    for (const std::string& line : console_.read(polled)) take_order(line);
    for (const std::string& line : robot_->advance(clock_.now())) say(line);
    server_.serve(polled, [this](TcpServer::Client& client) { take(client); });
    for (const std::string& line : robot_->advance(clock_.now())) say(line);
    flush_lines();
  }
}

void VirtualText::take(TcpServer::Client& client) {
  client_ = client.id;
  while (const auto request = robot_->take(client.input)) {
    print_line("asked " + escape_line(*request));
    const std::string answer = robot_->answer(client.id, *request, clock_.now());
    if (!mute_) server_.send(client, answer + std::string(robot_->end()));
  }
  if (client.input.size() > kLongestRequest) client.drop("bad_request");
}

/** To the client that has asked last, if it is still there. */
void VirtualText::say(const std::string& line) {
  print_line("said " + escape_line(line));
  TcpServer::Client* client = mute_ ? nullptr : server_.find(client_);
  if (client != nullptr) server_.send(*client, line + std::string(robot_->end()));
}

void VirtualText::take_order(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  if (order == "fault" && parse_fault_order(words)) {
    robot_->fail(clock_.now());
  } else if (order == "clear") {
    robot_->clear();
  } else if (order == "mute" || order == "speak") {
    mute_ = order == "mute";
  } else if (order == "say") {
    say(std::string(words));
  } else {
    print_line("unknown_line");
  }
}

}  // namespace trb::virtual_robots::text
