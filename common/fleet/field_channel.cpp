#include <algorithm>

#include "common/base/ids.hpp"
#include "common/fleet/description_parts.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/placeholders.hpp"

namespace trb {
namespace {

using Codes = std::map<std::string, std::int64_t>;

constexpr std::size_t kMaxCodes = 1000;
constexpr std::int64_t kLargestCode = 1'000'000;
constexpr std::int64_t kSmallestChunk = 4;  // an escape of two bytes must fit, and something besides
constexpr std::int64_t kLargestChunk = 65536;

Codes read_codes(ObjectReader& reader, std::string_view key) {
  Codes codes;
  std::map<std::int64_t, std::string> words;
  const auto* members = reader.object(key, Need::optional, kMaxCodes);
  if (members == nullptr) return codes;
  const Value json{*members};
  ObjectReader table(json, reader.path(key), reader.faults());
  for (const auto& [word, ignored] : *members) {
    if (!is_valid_word(word)) {
      reader.faults().add(table.path(word), in_quotes(word) + " is no word",
                          "start with a letter; then letters, digits");
    }
    // 0 is the node itself, -1 and -2 are stop and release.
    const auto code = table.integer(word, Need::required, 1, kLargestCode);
    if (!code) continue;
    codes[word] = *code;
    const auto [at, is_new] = words.emplace(*code, word);
    if (is_new) continue;
    reader.faults().add(table.path(word), std::to_string(*code) + " is already the number of " + in_quotes(at->second),
                        "give each word a number of its own");
  }
  return codes;
}

std::uint32_t read_chunk(ObjectReader& reader) {
  const auto bytes = reader.integer("chunk_bytes", Need::optional, 0, kLargestChunk).value_or(0);
  if (bytes == 0 || bytes >= kSmallestChunk) return static_cast<std::uint32_t>(bytes);
  reader.faults().add(reader.path("chunk_bytes"), std::to_string(bytes) + " is too small for a chunk",
                      "use 0 for no limit, or at least " + std::to_string(kSmallestChunk));
  return 0;
}

bool is_numeric_text(std::string_view text) {
  return text.find_first_not_of(" 0123456789+-.") == std::string_view::npos;
}

bool uses_text(const Skill& skill) {
  const Template data = parse_template(skill.data);
  return std::any_of(data.placeholders.begin(), data.placeholders.end(), [&](const Placeholder& placeholder) {
    return std::any_of(skill.parameters.begin(), skill.parameters.end(), [&](const Parameter& parameter) {
      return parameter.name == placeholder.name && parameter.type == ParameterType::text;
    });
  });
}

void check_code(const Codes& codes, const std::string& word, const std::string& why, const FileFaults& faults) {
  if (codes.contains(word)) return;
  faults.add("field_channel.codes.subtypes." + word, "the numeric encoding has no number for this " + why,
             "add \"" + word + "\" with a number of its own");
}

void check_drive_words(const FieldChannel& channel, const Skill& words, const std::string& key,
                       const FileFaults& faults) {
  check_code(channel.subtype_codes, words.subtype, "drive's subtype", faults);
  if (is_numeric_text(parse_template(words.data).literal)) return;
  faults.add(key, "the numeric encoding carries numbers only", "use numbers, spaces and placeholders of axes");
}

}  // namespace

FieldChannel read_field_channel(const Value& json, const FileFaults& faults) {
  ObjectReader reader(json, "field_channel", faults);
  FieldChannel channel;
  channel.framing = reader.one_of<Framing>("framing", Need::optional).value_or(channel.framing);
  channel.encoding = reader.one_of<Encoding>("encoding", Need::optional).value_or(channel.encoding);
  channel.acknowledge = reader.boolean("acknowledge", Need::optional).value_or(channel.acknowledge);
  channel.ack_timeout_s =
      reader.number("ack_timeout_s", Need::optional, {0, 3600, true}).value_or(channel.ack_timeout_s);
  channel.delay_s = reader.number("delay_s", Need::optional, {0, 10, true}).value_or(channel.delay_s);
  channel.chunk_bytes = read_chunk(reader);
  if (const Value* json_codes = reader.value("codes", Need::optional)) {
    ObjectReader codes(*json_codes, reader.path("codes"), faults);
    channel.subtype_codes = read_codes(codes, "subtypes");
    channel.id_codes = read_codes(codes, "ids");
    codes.refuse_unknown_keys();
  }
  reader.refuse_unknown_keys();
  return channel;
}

void check_numeric(const Description& description, const FileFaults& faults) {
  const FieldChannel& channel = description.field_channel;
  if (channel.encoding != Encoding::numeric) return;
  for (const char* word : {"done", "failed"}) check_code(channel.subtype_codes, word, "report of the robot", faults);
  for (const Skill& skill : description.skills) {
    check_code(channel.subtype_codes, skill.subtype, "skill's subtype", faults);
    if (is_numeric_text(parse_template(skill.data).literal) && !uses_text(skill)) continue;
    faults.add("skills." + skill.name + ".command.data", "the numeric encoding carries numbers only",
               "use numbers, spaces and placeholders of numeric parameters");
  }
  for (std::size_t i = 0; i < description.drives.size(); ++i) {
    const Drive& drive = description.drives[i];
    check_drive_words(channel, drive.command, "drives[" + std::to_string(i) + "].command.data", faults);
    if (drive.stand) {
      check_drive_words(channel, *drive.stand, "drives[" + std::to_string(i) + "].stand.data", faults);
    }
  }
}

}  // namespace trb
