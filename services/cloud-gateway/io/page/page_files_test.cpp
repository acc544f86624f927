// The files that are part of the program: each has a type, a route, and the same bytes twice.
#include "services/cloud-gateway/io/page/page_files.hpp"

#include <doctest/doctest.h>

#include <set>

#include "common/base/files.hpp"
#include "services/cloud-gateway/core/access/path.hpp"
#include "services/cloud-gateway/core/access/rights.hpp"
#include "tests/support/paths.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

const std::string kGateway = test::source_dir() + "/services/cloud-gateway/";

}  // namespace

TEST_CASE("the page, its favicon and the description of the API are the files of the repository, byte by byte") {
  const std::vector<std::pair<std::string, std::string>> files{{"/", "web/dist/index.html"},
                                                               {"/favicon.svg", "web/dist/favicon.svg"},
                                                               {"/api/v1/openapi.json", "api/openapi.json"}};
  for (const auto& [path, file] : files) {
    const std::string address = path;
    CAPTURE(address);
    const PageFile* found = find_page_file(path);
    REQUIRE(found != nullptr);
    CHECK(*found->plain == *read_file(kGateway + file));
    CHECK(found->cache_control == "no-cache");
  }
}

TEST_CASE("every file has a type, a tag of its own, a gzipped form, and a route that anyone may read") {
  std::set<std::string> tags;
  for (const PageFile& file : page_files()) {
    CAPTURE(file.path);
    CHECK_FALSE(file.content_type.empty());
    CHECK(tags.insert(file.tag).second);
    CHECK(file.gzipped->starts_with("\x1f\x8b\x08"));
    CHECK(file.gzipped->substr(4, 4) == std::string(4, '\0'));  // no time stamp: the same files, the same program
    const auto segments = split_path(file.path == "/index.html" ? "/" : file.path);
    REQUIRE(segments);
    const Match match = match_route("GET", *segments);
    REQUIRE(match.route != nullptr);
    CHECK(match.route->least == Least::anyone);
    CHECK(match.route->effect == Effect::reads);
  }
}

TEST_CASE("what the page names is there; assets are kept by a browser, for a change changes their names") {
  const std::string& page = *find_page_file("/")->plain;
  std::size_t named = 0;
  for (std::size_t at = page.find("\"/"); at != std::string::npos; at = page.find("\"/", at + 1), ++named) {
    const std::string path = page.substr(at + 1, page.find('"', at + 1) - at - 1);
    const std::string address = path;
    CAPTURE(address);
    const PageFile* file = find_page_file(path);
    REQUIRE(file != nullptr);
    CHECK(file->cache_control.ends_with("immutable") == path.starts_with("/assets/"));
  }
  CHECK(named >= 3);
}

TEST_CASE("a path that is not there has no file, whatever it looks like") {
  for (const char* path :
       {"", "index.html", "/assets", "/assets/", "/assets/none.js", "/assets/../favicon.svg", "assets", "/dist"})
    CHECK(find_page_file(path) == nullptr);
}

TEST_CASE("a file's type is known by its end") {
  CHECK(content_type_of("/a.html") == "text/html; charset=utf-8");
  CHECK(content_type_of("/a.js") == "text/javascript; charset=utf-8");
  CHECK(content_type_of("/a.exe").empty());
  CHECK(content_type_of("js").empty());
}
