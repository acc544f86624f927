// The page and the API's description: files that are part of the program.
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/conditional.hpp"
#include "services/cloud-gateway/io/page/page_files.hpp"

namespace trb::gateway {
namespace {

/// The gzipped bytes have a tag of their own (RFC 9110, 8.8.3.3).
void reply_file(const CallPtr& call, const PageFile& file) {
  const bool gzipped = call->request.accepts_gzip;
  HttpReply out;
  out.content_type = file.content_type;
  out.body = gzipped ? file.gzipped : file.plain;
  out.headers = {{"Cache-Control", std::string(file.cache_control)}, {"Vary", "Accept-Encoding"}};
  if (gzipped) out.headers.emplace_back("Content-Encoding", "gzip");
  reply_tagged(call, ETag{file.tag + (gzipped ? "-gz" : ""), false}, std::move(out));
}

void reply_path(const CallPtr& call, std::string_view path) {
  if (const PageFile* file = find_page_file(path)) return reply_file(call, *file);
  call->reply(problem_reply(404, "missing", "the page has no such file", "load the page again: GET /"));
}

}  // namespace

void add_page_routes(HandlerTable& table) {
  for (const char* path : {"/", "/favicon.svg", "/api/v1/openapi.json"})
    table.add(Method::get, path, [path](const CallPtr& call) { reply_path(call, path); });
  table.add(Method::get, "/assets/{file}",
            [](const CallPtr& call) { reply_path(call, "/assets/" + call->parameter("file")); });
}

}  // namespace trb::gateway
