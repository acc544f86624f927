// nodes, sensors, places.
#include <set>

#include "common/base/hex.hpp"
#include "common/config/hall_picture.hpp"
#include "common/operator/read_sensor.hpp"
#include "common/security/keys.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/conditional.hpp"
#include "services/cloud-gateway/io/api/lists.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr Duration kPictureWait = std::chrono::seconds(12);

RowKey sensor_key(RowKind kind, const Call& call) {
  return {kind, call.parameter("node"), call.parameter("sensor")};
}

/// A node chooses what it sends: nothing that a browser would run.
std::string picture_type(const std::string& told) {
  for (const char* known : {"image/jpeg", "image/png", "image/webp"}) {
    if (told == known) return told;
  }
  return "application/octet-stream";
}

void reply_picture(Gateway& gateway, const CallPtr& call, const op::FoundSensor& camera) {
  op::take_picture(gateway.session, camera, kPictureWait, [call](const Result<SensorImage>& image) {
    if (!image) return call->fail(image.error());
    HttpReply out;
    out.content_type = picture_type(image->media_type);
    out.body = std::make_shared<const Bytes>(image->bytes.bytes);
    call->reply(std::move(out));
  });
}

/// The last value that was received, if somebody watches the sensor; else its node is asked for the next one.
void read_value(Gateway& gateway, const CallPtr& call) {
  const Row* watched = gateway.book.find(sensor_key(RowKind::reading, *call));
  if (watched != nullptr && watched->live == Live::live) {
    return reply_row(gateway, call, sensor_key(RowKind::reading, *call));
  }
  op::SensorWish wish;
  wish.name = call->parameter("sensor");
  wish.node = call->parameter("node");
  op::look_up_sensor(gateway.session, wish, [&gateway, call](const Result<op::FoundSensor>& found) {
    if (!found) return call->fail(found.error());
    if (found->info.kind == "image") return reply_picture(gateway, call, *found);
    op::read_sensor(gateway.session, *found, std::nullopt, op::kAnswerWait, [call](const Result<SensorReading>& value) {
      if (!value) return call->fail(value.error());
      call->reply(json_reply(json_record(*value)));
    });
  });
}

std::string json_pose(const std::string& name, const Pose& pose) {
  JsonObject out;
  out.text("name", name);
  for (const auto& [key, value] : {std::pair("x", pose.x), {"y", pose.y}, {"z", pose.z}, {"yaw", pose.yaw}}) {
    out.raw(key, dump_json(Value{value}));
  }
  return out.done();
}

std::string json_box(const HallBox& box) {
  JsonObject out;
  for (const auto& [key, value] :
       {std::pair("west", box.west), {"south", box.south}, {"east", box.east}, {"north", box.north}}) {
    out.raw(key, dump_json(Value{value}));
  }
  return out.done();
}

/// The names that robots know, and the poses of the hall; where its picture lies, if there is one.
void list_places(const Gateway& gateway, const CallPtr& call) {
  std::set<std::string> names;
  gateway.book.each(RowKind::profile, [&](const Row& row) {
    const auto* profile = std::get_if<NodeProfile>(&row.content);
    if (profile != nullptr) names.insert(profile->places.begin(), profile->places.end());
  });
  JsonList out;
  for (const std::string& name : names) out.add(json_quoted(name));
  JsonList poses;
  for (const auto& [name, pose] : gateway.places) poses.add(json_pose(name, pose));
  JsonObject reply;
  reply.raw("places", out.done()).raw("poses", poses.done());
  ConfigFaults faults;  // trb check tells them
  if (const auto picture = read_hall_picture(gateway.node_dir, faults)) reply.raw("picture", json_box(picture->box));
  call->reply(json_reply(reply.done()));
}

/// The walls of this hall, if its people have drawn them.
void reply_picture(const Gateway& gateway, const CallPtr& call) {
  ConfigFaults faults;
  auto picture = read_hall_picture(gateway.node_dir, faults);
  if (!picture) {
    return call->reply(problem_reply(404, "missing", "the node's folder has no hall.svg that can be drawn",
                                     faults.empty() ? "put one there" : faults[0].hint));
  }
  const std::string tag = to_hex(digest(picture->svg)).substr(0, 32);
  HttpReply out;
  out.content_type = "image/svg+xml";
  out.body = std::make_shared<const Bytes>(std::move(picture->svg));
  out.headers = {{"Cache-Control", "no-cache"}};
  reply_tagged(call, ETag{tag, false}, std::move(out));
}

}  // namespace

void add_fleet_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/nodes", [&](const CallPtr& call) { reply_rows(gateway, call, RowKind::node); });
  table.add(Method::get, "/api/v1/nodes/{node}", [&](const CallPtr& call) {
    reply_row(gateway, call, {RowKind::node, call->parameter("node"), ""});
  });
  table.add(Method::get, "/api/v1/sensors", [&](const CallPtr& call) { reply_rows(gateway, call, RowKind::sensor); });
  table.add(Method::get, "/api/v1/sensors/{node}/{sensor}",
            [&](const CallPtr& call) { reply_row(gateway, call, sensor_key(RowKind::sensor, *call)); });
  table.add(Method::get, "/api/v1/sensors/{node}/{sensor}/value",
            [&](const CallPtr& call) { read_value(gateway, call); });
  table.add(Method::get, "/api/v1/places", [&](const CallPtr& call) { list_places(gateway, call); });
  table.add(Method::get, "/api/v1/places/picture", [&](const CallPtr& call) { reply_picture(gateway, call); });
}

}  // namespace trb::gateway
