// histories of robots and sensors.
#include "common/base/number_text.hpp"
#include "services/cloud-gateway/core/live/page_cursor.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::uint64_t kPage = 100;
constexpr std::uint64_t kMaxHistoryPage = 5000;
constexpr std::uint64_t kCsvPage = 10'000;
constexpr std::uint64_t kMaxCsvPage = 100'000;

/// What a cursor belongs to: another robot's history starts anew.
std::string list_of(const HistoryQuery& query) {
  return "history/" + query.node + "/" + query.sensor;
}

std::string text_of(const HistoryQuery& query, const HistoryPlace& place) {
  return cursor_text({list_of(query), std::to_string(place.time) + " " + std::to_string(place.number)});
}

Status read_cursor(const Call& call, HistoryQuery& out) {
  const std::string text = call.query("cursor");
  if (text.empty()) return Done{};
  const auto cursor = parse_cursor(text, list_of(out));
  if (!cursor) return cursor.error();
  const std::size_t space = cursor->after.find(' ');
  const auto time = parse_number<std::int64_t>(cursor->after.substr(0, space));
  const auto number = parse_number<std::int64_t>(space == std::string::npos ? "" : cursor->after.substr(space + 1));
  if (!time || !number) return fail(Errc::malformed, "cursor: this is none", "take it from `next` of the page before");
  out.before = {*time, *number};
  return Done{};
}

/// `?from=`, `?to=`: a time of ISO 8601.
Status read_time(const Call& call, std::string_view key, std::int64_t& out) {
  const std::string text = call.query(key);
  if (text.empty()) return Done{};
  const auto time = from_iso8601(text);
  if (!time)
    return fail(Errc::bad_value, std::string(key) + ": '" + text.substr(0, 60) + "' is no time",
                "write 2026-03-01T12:00:00Z");
  out = time->ns;
  return Done{};
}

Status read_kind(const Call& call, HistoryQuery& out) {
  const std::string given = call.query("kind");
  if (given.empty()) return Done{};
  std::string all;
  constexpr auto kNames = enum_names(HistoryKind{});
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == given) out.kind = static_cast<HistoryKind>(i);
    all += (i == 0 ? "" : ", ") + std::string(kNames[i]);
  }
  if (out.kind) return Done{};
  return fail(Errc::bad_value, "kind: '" + given.substr(0, 60) + "'", "use one of: " + all);
}

struct PageSize {
  std::uint64_t usual = kPage;
  std::uint64_t most = kMaxHistoryPage;
};

Result<HistoryQuery> history_query(const Call& call, HistoryQuery out, const PageSize& size) {
  const auto limit = call.query_number("limit", size.usual, size.most);
  if (!limit) return limit.error();
  if (*limit == 0) return fail(Errc::bad_value, "limit: 0", "use 1 to " + std::to_string(size.most));
  out.most = static_cast<std::size_t>(*limit);
  for (const Status& read : {read_time(call, "from", out.from), read_time(call, "to", out.to), read_kind(call, out),
                             read_cursor(call, out)}) {
    if (!read) return read.error();
  }
  return out;
}

std::string json_entry(const HistoryEntry& entry) {
  JsonObject out;
  out.time("time", entry.time).text("kind", name_of(entry.kind)).text("about", entry.about);
  return out.raw("value", entry.value).text("detail", entry.detail).done();
}

std::string json_reading(const HistoryEntry& entry) {
  JsonObject out;
  out.time("time", entry.time).raw("value", entry.value).text("unit", entry.about);
  return out.text("quality", entry.detail).done();
}

std::string json_page(const HistoryQuery& query, const HistoryPage& page) {
  JsonList items;
  for (const HistoryEntry& one : page.entries) items.add(query.sensor.empty() ? json_entry(one) : json_reading(one));
  return JsonObject().raw("items", items.done()).text("next", page.next ? text_of(query, *page.next) : "").done();
}

/// Of RFC 4180. A spreadsheet takes a text that begins so for a formula: it gets an apostrophe, as OWASP advises.
std::string csv_text(std::string text) {
  if (!text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos) text.insert(0, "'");
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

std::string csv_value(const std::string& json) {
  const auto value = parse_json(json);
  return value && value->is_text() ? csv_text(value->text()) : json;
}

/// The same request for what is older (RFC 8288).
std::string link_to_next(const std::string& target, const std::string& cursor) {
  const std::size_t question = target.find('?');
  std::string out = target.substr(0, question) + "?cursor=" + cursor;
  std::string_view rest = question == std::string::npos ? "" : std::string_view(target).substr(question + 1);
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
    if (!pair.starts_with("cursor=")) out += "&" + std::string(pair);
  }
  return "<" + out + ">; rel=\"next\"";
}

/// The oldest first.
HttpReply csv_reply(const std::string& target, const HistoryQuery& query, const HistoryPage& page) {
  std::string out = "time,value,unit,quality\r\n";
  for (auto at = page.entries.rbegin(); at != page.entries.rend(); ++at) {
    out += to_iso8601(at->time) + "," + csv_value(at->value) + "," + csv_text(at->about) + "," + csv_text(at->detail) +
           "\r\n";
  }
  HttpReply reply = json_reply(std::move(out));
  reply.content_type = "text/csv; charset=utf-8";
  reply.headers.emplace_back("Content-Disposition", "attachment; filename=\"history.csv\"");
  if (page.next) reply.headers.emplace_back("Link", link_to_next(target, text_of(query, *page.next)));
  return reply;
}

bool is_known(const Gateway& gateway, const HistoryQuery& query) {
  const RowKind kind = query.sensor.empty() ? RowKind::robot : RowKind::sensor;
  return gateway.book.find({kind, query.node, query.sensor}) != nullptr;
}

/// Called on the history's thread.
using Shown = std::function<HttpReply(const Call&, const HistoryQuery&, const HistoryPage&)>;

/// 404: nothing was ever heard of it.
void reply_found(const Gateway& gateway, Call& call, const HistoryQuery& query, bool is_empty, HttpReply reply) {
  if (!is_empty || is_known(gateway, query)) return call.reply(std::move(reply));
  call.reply(problem_reply(404, "missing", "there is no such " + std::string(query.sensor.empty() ? "robot" : "sensor"),
                           "look at the list of them"));
}

/// What is wrong with the file, and nothing with the request.
bool is_of_file(const Error& error) {
  return error.code == Errc::malformed || error.code == Errc::io_error || error.code == Errc::version_mismatch;
}

void reply_unread(Call& call, const Error& error) {
  if (!is_of_file(error)) return call.fail(error);
  call.reply(problem_reply(503, "no_history", "the history cannot be read",
                           "trb service list at the cloud node says why; it goes on by itself"));
}

void reply_history(Gateway& gateway, const CallPtr& call, const HistoryQuery& of, const PageSize& size, Shown shown) {
  const auto query = history_query(*call, of, size);
  if (!query) return call->fail(query.error());
  const auto found = [&gateway, call, query = *query, shown = std::move(shown)](const Result<HistoryPage>& page) {
    std::function<void()> then;
    if (!page) {
      then = [&gateway, call, error = page.error()] {
        if (is_of_file(error)) gateway.on_history_read(error);
        reply_unread(*call, error);
      };
    } else {
      then = [&gateway, call, query, is_empty = page->entries.empty(), reply = shown(*call, query, *page)] {
        gateway.on_history_read(Done{});
        reply_found(gateway, *call, query, is_empty, reply);
      };
    }
    return then;
  };
  gateway.history.find(*query, found);
}

HttpReply shown_as_json(const Call&, const HistoryQuery& query, const HistoryPage& page) {
  return json_reply(json_page(query, page));
}

HttpReply shown_as_csv(const Call& call, const HistoryQuery& query, const HistoryPage& page) {
  return csv_reply(call.request.target, query, page);
}

HistoryQuery robot_query(const Call& call) {
  HistoryQuery out;
  out.node = call.parameter("robot");
  return out;
}

HistoryQuery sensor_query(const Call& call) {
  HistoryQuery out;
  out.node = call.parameter("node");
  out.sensor = call.parameter("sensor");
  return out;
}

}  // namespace

void add_history_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/robots/{robot}/history",
            [&](const CallPtr& call) { reply_history(gateway, call, robot_query(*call), {}, shown_as_json); });
  table.add(Method::get, "/api/v1/sensors/{node}/{sensor}/history",
            [&](const CallPtr& call) { reply_history(gateway, call, sensor_query(*call), {}, shown_as_json); });
  table.add(Method::get, "/api/v1/sensors/{node}/{sensor}/history.csv", [&](const CallPtr& call) {
    reply_history(gateway, call, sensor_query(*call), {kCsvPage, kMaxCsvPage}, shown_as_csv);
  });
}

}  // namespace trb::gateway
