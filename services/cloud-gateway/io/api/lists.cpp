#include "services/cloud-gateway/io/api/lists.hpp"

#include <map>

#include "services/cloud-gateway/core/live/page_cursor.hpp"
#include "services/cloud-gateway/io/api/conditional.hpp"
#include "services/cloud-gateway/io/json_rows.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::uint64_t kRowsPage = 100;

std::map<std::string, const Row*> rows_by_key(const RowBook& book, RowKind kind) {
  std::map<std::string, const Row*> out;
  book.each(kind, [&](const Row& row) { out[row.key.node + "/" + row.key.name] = &row; });
  return out;
}

}  // namespace

void reply_rows(const Gateway& gateway, const CallPtr& call, RowKind kind) {
  const auto limit = call->query_number("limit", kRowsPage, kMaxPage);
  if (!limit) return call->fail(limit.error());
  const auto rows = rows_by_key(gateway.book, kind);
  const auto page =
      page_of(rows, call->decision.route->path, call->query("cursor"), static_cast<std::uint32_t>(*limit));
  if (!page) return call->fail(page.error());
  JsonList items;
  for (const auto* entry : page->entries) items.add(*json_of(*entry->second));
  JsonObject out;
  out.raw("items", items.done()).text("next", page->next);
  if (const RowSources silent = gateway.fleet.silent(); !silent.empty()) out.raw("silent", json_silent(silent));
  call->reply(json_reply(out.done()));
}

void reply_row(const Gateway& gateway, const CallPtr& call, const RowKey& key) {
  const Row* row = gateway.book.find(key);
  if (row == nullptr) {
    const std::string what(name_of(key.kind));
    return call->reply(problem_reply(404, "missing", "there is no such " + what, "look at the list one level up"));
  }
  reply_tagged(call, etag_of(gateway.clients.instance(), *row), json_reply(json_of(*row)));
}

}  // namespace trb::gateway
