// health, ready, metrics.
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

void ready(const Gateway& gateway, const CallPtr& call) {
  if (!gateway.is_ready()) {
    return call->reply(problem_reply(503, "no_router", "this node's router does not answer", "see trb service list"));
  }
  if (gateway.database_gone) {
    return call->reply(problem_reply(503, "no_database", "the gateway's database does not answer", "see its log"));
  }
  if (gateway.access.unwritten()) {
    return call->reply(problem_reply(503, "disk_full", "nothing can be put on record; stops and sign-ins go on",
                                     "see trb service list"));
  }
  if (!gateway.fleet.knows_fleet()) {
    return call->reply(problem_reply(503, "no_fleet", "this node's router has not told its nodes yet", "ask again"));
  }
  call->reply(json_reply(R"({"status":"ready"})"));
}

std::size_t rows_of(const RowBook& book, RowKind kind) {
  std::size_t out = 0;
  book.each(kind, [&](const Row&) { ++out; });
  return out;
}

/// The Prometheus text exposition, version 0.0.4.
std::string metrics_of(const Gateway& gateway) {
  std::string out = "# TYPE trb_gateway_replies_total counter\n";
  for (const auto& [status, count] : gateway.counts.replies) {
    out += "trb_gateway_replies_total{status=\"" + std::to_string(status) + "\"} " + std::to_string(count) + "\n";
  }
  out += "# TYPE trb_gateway_live_frames_total counter\ntrb_gateway_live_frames_total ";
  out += std::to_string(gateway.counts.frames) + "\n# TYPE trb_gateway_live_clients gauge\ntrb_gateway_live_clients ";
  out += std::to_string(gateway.sockets.size()) + "\n# TYPE trb_gateway_rows gauge\n";
  for (const RowKind kind : {RowKind::node, RowKind::robot, RowKind::run, RowKind::alert, RowKind::sensor}) {
    out += "trb_gateway_rows{kind=\"" + std::string(name_of(kind)) + "\"} " +
           std::to_string(rows_of(gateway.book, kind)) + "\n";
  }
  out += "# TYPE trb_gateway_history_lost_total counter\ntrb_gateway_history_lost_total " +
         std::to_string(gateway.recorder.lost()) + "\n";
  out += "# TYPE trb_gateway_certificate_ends_seconds gauge\ntrb_gateway_certificate_ends_seconds " +
         std::to_string(gateway.certificate_ends.ns / 1'000'000'000) + "\n";
  return out + "# TYPE trb_gateway_sessions gauge\ntrb_gateway_sessions " +
         std::to_string(gateway.access.sessions.size()) + "\n";
}

void metrics(const Gateway& gateway, const CallPtr& call) {
  HttpReply out = json_reply(metrics_of(gateway));
  out.content_type = "text/plain; version=0.0.4; charset=utf-8";
  call->reply(std::move(out));
}

}  // namespace

void add_status_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/health", [](const CallPtr& call) { call->reply(json_reply(R"({"status":"ok"})")); });
  table.add(Method::get, "/api/v1/ready", [&](const CallPtr& call) { ready(gateway, call); });
  table.add(Method::get, "/metrics", [&](const CallPtr& call) { metrics(gateway, call); });
}

}  // namespace trb::gateway
