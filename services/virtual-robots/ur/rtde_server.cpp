#include "services/virtual-robots/ur/rtde_server.hpp"

#include <algorithm>
#include <limits>

#include "services/virtual-robots/support/process.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {

void RtdeServer::serve(const std::vector<pollfd>& polled, Controller& controller, double now) {
  server_.serve(polled, [&](TcpServer::Client& client) { take(client, controller, now); });
  forget_gone();
}

void RtdeServer::forget_gone() {
  std::erase_if(sessions_, [&](const auto& entry) { return server_.find(entry.first) == nullptr; });
}

void RtdeServer::take(TcpServer::Client& client, Controller& controller, double now) {
  auto& session = sessions_[client.id];
  if (!session) session = std::make_unique<RtdeSession>(client.id, claims_);
  const std::string answers = session->take(client.input, written_, wall_seconds());
  for (const std::string& text : session->take_texts()) print_line("rtde_text " + escape_line(text));
  if (session->take_changes()) apply(written_, controller, now);
  if (session->broken()) return client.drop("bad_package");
  server_.send(client, answers);
}

void RtdeServer::send_due(const Controller& controller, double now) {
  const double time = wall_seconds();
  if (next_due() > time) return;
  const RtdePicture picture{controller.state(now), now, controller.input_registers(), controller.output_registers()};
  for (auto& [id, session] : sessions_) {
    const std::string data = session->data(picture, time);
    TcpServer::Client* client = server_.find(id);
    if (data.empty() || client == nullptr || client->output.size() > kMostUnread) continue;
    server_.send(*client, data);
  }
}

double RtdeServer::next_due() const {
  double next = std::numeric_limits<double>::infinity();
  for (const auto& [id, session] : sessions_) {
    if (const auto due = session->next_due()) next = std::min(next, *due);
  }
  return next;
}

}  // namespace trb::virtual_robots::ur
