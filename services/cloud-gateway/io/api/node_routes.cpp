// services, links, doctor: of this node, and of the nodes that it is linked with.
#include "common/operator/routes.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

/// A node of the query; empty: not there. Only nodes that are known: the gateway connects nowhere else for a stranger.
Result<std::string> node_in(const Gateway& gateway, const Call& call, std::string_view key) {
  std::string node = call.query(key);
  if (node.empty() || gateway.book.find({RowKind::node, node, ""}) != nullptr) return node;
  return fail(Errc::unknown_target, std::string(key) + ": there is no node '" + cut_utf8(node, 64) + "'",
              "GET /api/v1/nodes");
}

/// `?node=`: of another node than this one.
void list_services(Gateway& gateway, const CallPtr& call) {
  const auto node = node_in(gateway, *call, "node");
  if (!node) return call->fail(node.error());
  const std::string& target = node->empty() ? gateway.session.node() : *node;
  gateway.session.request(Send{.type = MessageType::request, .target = target, .body = ServiceListRequest{}},
                          [call](const Result<Message>& answer) {
                            const auto table = answer ? decode<ServiceTable>(answer->data) : answer.error();
                            if (!table) return call->fail(table.error());
                            call->reply(json_reply(to_json(*table)));
                          });
}

std::string json_link(const trb::Route& route) {
  JsonObject out;
  out.text("peer", route.id).text("address", route.address).text("state", route.state);
  out.raw("last_heard_s", dump_json(Value{route.last_heard_s})).text("via", route.via);
  return out.text("dialled_by", route.dialled_by).done();
}

std::string json_links(const RouteTable& routes, const LinkErrorTable& errors) {
  JsonList links;
  for (const trb::Route& route : routes.routes) {
    if (route.state != "self") links.add(json_link(route));
  }
  JsonList rows;
  for (const LinkErrorRow& one : errors.errors) rows.add(json_record(one));
  return JsonObject().text("node", routes.node).raw("links", links.done()).raw("errors", rows.done()).done();
}

void list_links(Gateway& gateway, const CallPtr& call) {
  op::request_routes(gateway.session, [&gateway, call](const Result<RouteTable>& routes) {
    if (!routes) return call->fail(routes.error());
    gateway.session.ask_node<LinkErrorTable>(LinkErrorTableRequest{},
                                             [call, routes = *routes](const Result<LinkErrorTable>& errors) {
                                               if (!errors) return call->fail(errors.error());
                                               call->reply(json_reply(json_links(routes, *errors)));
                                             });
  });
}

std::string json_finding(const op::Finding& finding) {
  JsonObject out;
  out.text("severity", finding.weight == op::Weight::problem ? "problem" : "note").text("cause", finding.cause);
  return out.text("subject", finding.subject).text("what", finding.what).text("cure", finding.hint).done();
}

std::string json_examination(const op::Examination& examination) {
  JsonList findings;
  bool well = true;
  for (const op::Finding& one : examination.findings) {
    findings.add(json_finding(one));
    well = well && one.weight != op::Weight::problem;
  }
  JsonObject out;
  return out.text("node", examination.seen.node).flag("well", well).raw("findings", findings.done()).done();
}

/// What `trb doctor --json` says; `?peer=`: only the link with that one. It takes seconds, and is done for one at a
/// time.
void examine(Gateway& gateway, const CallPtr& call) {
  const auto peer = node_in(gateway, *call, "peer");
  if (!peer) return call->fail(peer.error());
  if (gateway.doctor->is_busy()) {
    HttpReply out = problem_reply(429, "busy", "another examination is under way", "try again in some seconds");
    out.headers.emplace_back("Retry-After", "5");
    return call->reply(std::move(out));
  }
  gateway.doctor->examine({*peer}, {.done = [call](const op::Examination& examination) {
                            call->reply(json_reply(json_examination(examination)));
                          }});
}

}  // namespace

void add_node_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/services", [&](const CallPtr& call) { list_services(gateway, call); });
  table.add(Method::get, "/api/v1/links", [&](const CallPtr& call) { list_links(gateway, call); });
  table.add(Method::get, "/api/v1/doctor", [&](const CallPtr& call) { examine(gateway, call); });
}

}  // namespace trb::gateway
