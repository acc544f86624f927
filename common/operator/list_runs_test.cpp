#include "common/operator/list_runs.hpp"

#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

RunTable table(const std::vector<std::string>& runs, bool more = false) {
  RunTable out;
  for (const std::string& run : runs) {
    RunSummary row;
    row.run = run;
    out.runs.push_back(row);
  }
  out.more = more;
  return out;
}

std::string names(const RunTable& table) {
  std::string out;
  for (const RunSummary& run : table.runs) out += run.run;
  return out;
}

}  // namespace

TEST_CASE("the runs that are not over are one question") {
  FakeNode node;
  Ending<RunTable> ending;
  list_runs(node.session(), false, ending);
  CHECK_FALSE(node.take<RunListRequest>().all);
  node.answer(table({"a", "b"}));
  CHECK(names(ending.value()) == "ab");
  CHECK(node.is_quiet());
}

TEST_CASE("the archive is read page after page; a run that ends meanwhile is listed once") {
  FakeNode node;
  Ending<RunTable> ending;
  list_runs(node.session(), true, ending);
  node.take<RunListRequest>();
  node.answer(table({"a", "b"}));
  const auto first = node.take<RunListRequest>();
  CHECK(first.all);
  CHECK(first.after.empty());
  node.answer(table({"b", "c"}, true));
  CHECK(node.take<RunListRequest>().after == "c");
  SUBCASE("to its last page") {
    node.answer(table({"d"}));
    CHECK(names(ending.value()) == "abcd");
    CHECK_FALSE(ending.value().more);
  }
  SUBCASE("unless the same page comes again") {
    node.answer(table({"b", "c"}, true));
    CHECK(names(ending.value()) == "abc");
  }
  SUBCASE("an error of any page is the list's") {
    node.refuse(Errc::io_error, "no archive");
    CHECK(ending.error().code == Errc::io_error);
  }
  CHECK(node.is_quiet());
}
