#include "common/drivers/ros/syntax.hpp"

#include <algorithm>

#include "common/drivers/text/next_word.hpp"
#include "proto/value.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxFields = 32;

bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= 200 && std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '/';
  });
}

/// As ROS wants it: a letter or '/' first.
bool is_topic(std::string_view text) {
  return is_name(text) && text.front() != '_' && !(text.front() >= '0' && text.front() <= '9');
}

/// The data with 0 for each placeholder: {data}, {0} … {99}.
std::string filled(std::string_view data) {
  std::string out;
  while (!data.empty()) {
    const std::size_t end = data.front() == '{' ? data.find('}') : std::string_view::npos;
    const std::string_view inside = end == std::string_view::npos ? "" : data.substr(1, end - 1);
    const bool number = !inside.empty() && inside.size() <= 2 &&
                        std::ranges::all_of(inside, [](char c) { return c >= '0' && c <= '9'; });
    if (number || inside == "data") {
      out += '0';
      data.remove_prefix(end + 1);
    } else {
      out += data.front();
      data.remove_prefix(1);
    }
  }
  return out;
}

}  // namespace

Result<std::vector<RosPublication>> read_ros_publications(std::string_view text) {
  std::vector<RosPublication> out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    RosPublication publication;
    publication.topic = next_word(line);
    if (publication.topic.empty()) continue;
    if (!is_topic(publication.topic)) {
      return fail(Errc::bad_value, "'" + publication.topic.substr(0, 60) + "' is no topic",
                  "begin it with a letter or '/', for example /cmd_vel");
    }
    if (!line.empty() && line.front() != '{' && line.front() != '[') {
      publication.type = next_word(line);
      if (!is_name(publication.type) || std::ranges::count(publication.type, '/') != 1) {
        return fail(Errc::bad_value, "'" + publication.type.substr(0, 60) + "' is no message type",
                    "write it as geometry_msgs/Twist");
      }
    }
    publication.data = line.empty() ? "{data}" : std::string(line);
    if (const auto json = parse_json(filled(publication.data)); !json) {
      return fail(Errc::bad_value, "the data of " + publication.topic + ": " + json.error().what, json.error().hint);
    }
    out.push_back(std::move(publication));
  }
  return out;
}

Result<RosQuestion> read_ros_question(std::string_view text) {
  RosQuestion question{std::string(next_word(text)), {}};
  if (!is_topic(question.topic)) {
    return fail(Errc::bad_value, "'" + question.topic.substr(0, 60) + "' is no topic",
                "write \"TOPIC\" or \"TOPIC FIELD ...\", for example \"/odom pose.pose.position.x\"");
  }
  while (!text.empty()) question.fields.emplace_back(next_word(text));
  if (question.fields.size() > kMaxFields) return fail(Errc::bad_value, "more than 32 fields", "ask for fewer");
  return question;
}

}  // namespace trb::drivers
