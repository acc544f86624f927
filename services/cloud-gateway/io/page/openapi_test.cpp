// The API's description names the routes that there are, and describes the bodies as proto does.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "proto/bodies/bus.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/resilience.hpp"
#include "proto/bodies/run_view.hpp"
#include "proto/make_shape.hpp"
#include "proto/value.hpp"
#include "services/cloud-gateway/core/access/rights.hpp"
#include "services/cloud-gateway/io/page/page_files.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

const Value& document() {
  static const auto parsed = parse_json(*find_page_file("/api/v1/openapi.json")->plain);
  REQUIRE_MESSAGE(parsed.ok(), (parsed ? "" : parsed.error().text()));
  return *parsed;
}

const Value& at(const Value& in, std::string_view key) {
  const Value* found = in.find(key);
  REQUIRE_MESSAGE(found != nullptr, key);
  return *found;
}

/// The schema, or the component that it refers to.
const Value& schema_behind(const Value& schema) {
  const Value* reference = schema.find("$ref");
  if (reference == nullptr) return schema;
  const std::string& target = reference->text();
  return at(at(at(document(), "components"), "schemas"), target.substr(target.rfind('/') + 1));
}

std::string lower(std::string_view method) {
  std::string out(method);
  std::ranges::transform(out, out.begin(), [](char c) { return static_cast<char>(c | 0x20); });
  return out;
}

std::string role_in_words(Least least) {
  return least == Least::anyone ? "anyone" : std::string(name_of(static_cast<UserRole>(static_cast<int>(least) - 1)));
}

const Value* operation_of(const gateway::Route& route) {
  const Value* path = at(document(), "paths").find(route.path);
  return path == nullptr ? nullptr : path->find(lower(name_of(route.method)));
}

// ---- bodies

std::string type_of(FieldKind kind) {
  if (kind == FieldKind::boolean) return "boolean";
  if (kind == FieldKind::number) return "number";
  if (kind == FieldKind::list) return "array";
  if (kind == FieldKind::record) return "object";
  return kind == FieldKind::text || kind == FieldKind::blob || kind == FieldKind::enumeration ? "string" : "integer";
}

void check_same(const Shape& shape, std::uint32_t most, const Value& described);

void check_fields(const Shape& shape, const Value& schema) {
  const Value::Object& properties = at(schema, "properties").object();
  CHECK(properties.size() == shape.fields.size());
  CHECK(at(schema, "required").list().size() == shape.fields.size());
  for (const FieldEntry& field : shape.fields) {
    CAPTURE(field.name);
    check_same(*field.shape, field.max, at(at(schema, "properties"), field.name));
  }
}

void check_names(const Shape& shape, const Value& schema) {
  std::vector<std::string> described;
  for (const Value& name : at(schema, "enum").list()) described.push_back(name.text());
  CHECK(described == std::vector<std::string>(shape.names.begin(), shape.names.end()));
}

void check_same(const Shape& shape, std::uint32_t most, const Value& described) {
  const Value& schema = schema_behind(described);
  if (shape.kind == FieldKind::uint64) {
    CHECK(at(schema, "type").list().size() == 2);  // a number beyond 2^53 goes as text
    return;
  }
  CHECK(at(schema, "type").text() == type_of(shape.kind));
  if (shape.kind == FieldKind::text) CHECK(at(schema, "maxLength").integer() == most);
  if (shape.kind == FieldKind::blob) CHECK(at(schema, "maxLength").integer() == 2 * std::int64_t{most});
  if (shape.kind == FieldKind::enumeration) check_names(shape, schema);
  if (shape.kind == FieldKind::record) check_fields(shape, schema);
  if (shape.kind != FieldKind::list) return;
  CHECK(at(schema, "maxItems").integer() == most);
  check_same(*shape.list.item, kDefaultMaxSize, at(schema, "items"));
}

/// Nothing for anybody; cookie or token for what reads; for a change as the document says it for all: the CSRF value,
/// too.
void check_security(const gateway::Route& route, const Value* described) {
  const bool is_said = route.least == Least::anyone || route.method == Method::get;
  REQUIRE((described != nullptr) == is_said);
  if (!is_said) return;
  CHECK(described->list().size() == (route.least == Least::anyone ? 0 : 2));
  for (const Value& one : described->list()) CHECK(one.find("csrf") == nullptr);
}

template <class Record>
void check_record(const char* name) {
  CAPTURE(name);
  check_same(make_shape<Record>(), 0, at(at(at(document(), "components"), "schemas"), name));
}

}  // namespace

TEST_CASE("every route is described, with who may use it") {
  for (const gateway::Route& route : routes()) {
    CAPTURE(route.path);
    CAPTURE(name_of(route.method));
    const Value* operation = operation_of(route);
    REQUIRE(operation != nullptr);
    CHECK(at(*operation, "x-role").text() == role_in_words(route.least));
    CHECK((operation->find("x-people-only") != nullptr) == route.people_only);
    check_security(route, operation->find("security"));
  }
}

TEST_CASE("nothing else is described") {
  std::set<std::string> there;
  for (const gateway::Route& route : routes())
    there.insert(lower(name_of(route.method)) + " " + std::string(route.path));
  for (const auto& [path, operations] : at(document(), "paths").object()) {
    for (const auto& [method, operation] : operations.object()) CHECK(there.contains(method + " " + path));
  }
}

TEST_CASE("the fleet's bodies are described as they are sent") {
  check_record<NodeProfile>("Profile");
  check_record<RunSummary>("RunSummary");
  check_record<RunView>("RunView");
  check_record<Alert>("Alert");
  check_record<SensorInfo>("Sensor");
  check_record<SensorReading>("SensorReading");
  check_record<OutOfUse>("OutOfUse");
  check_record<ServiceEntry>("Service");
  check_record<LinkErrorRow>("LinkError");
  check_record<Ack>("Ack");
}
