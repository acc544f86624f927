#include <algorithm>
#include <cctype>

#include "common/base/ids.hpp"
#include "common/config/readers.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb {
namespace {

using Words = std::map<std::string, std::string>;

constexpr std::size_t kMaxWords = 256;
constexpr std::size_t kMaxVendors = 64;
constexpr std::size_t kMaxTemplate = 16384;

bool is_index(std::string_view text) {
  return text.size() <= 2 && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool is_word_like(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
  });
}

/// The first {WORD} that is neither {data} nor {0}; other brackets belong to the vendor's language.
std::string foreign_placeholder(std::string_view words) {
  for (std::size_t open = words.find('{'); open != std::string_view::npos; open = words.find('{', open + 1)) {
    const std::size_t close = words.find('}', open);
    if (close == std::string_view::npos) break;
    const std::string_view inside = words.substr(open + 1, close - open - 1);
    if (is_word_like(inside) && inside != "data" && !is_index(inside)) return std::string(inside);
  }
  return {};
}

Words read_words(ObjectReader& vendor, std::string_view key) {
  Words words;
  const auto* members = vendor.object(key, Need::optional, kMaxWords);
  if (members == nullptr) return words;
  const Value json{*members};
  ObjectReader reader(json, vendor.path(key), vendor.faults());
  for (const auto& [subtype, ignored] : *members) {
    if (!is_valid_word(subtype)) {
      reader.faults().add(reader.path(subtype), in_quotes(subtype) + " is no subtype",
                          "use a letter, then letters, digits, _");
    }
    const std::string text = reader.text(subtype, Need::required, kMaxTemplate).value_or("unreadable");
    const std::string foreign = foreign_placeholder(text);
    if (!foreign.empty()) {
      reader.faults().add(reader.path(subtype), "{" + foreign + "} is no placeholder here",
                          "use {data} for all of the data, or {0}, {1} … for its parts");
    }
    words[subtype] = text;
  }
  return words;
}

/// One of the names, or `preset`; without transports any text is accepted.
std::string read_name(ObjectReader& reader, std::string_view key, Need need, const Transports& known,
                      const std::vector<std::string>& names, const std::string& preset = "") {
  if (known.empty()) return reader.text(key, need).value_or(preset);
  const auto index = reader.choice(key, need, names);
  return index ? names[*index] : preset;
}

/// The transport's own keys. If no transport is named, it may be the first one of any mode.
void read_own_keys(ObjectReader& reader, const Transports& known, VendorCommands& vendor) {
  for (const std::string& name : known.names()) {
    const Transport& row = *known.find(name);
    const bool meant = vendor.transport.empty() ? known.default_of(row.mode) == name : vendor.transport == name;
    if (meant && row.read != nullptr) row.read(reader, vendor);
  }
}

std::optional<Monitor> read_monitor(ObjectReader& vendor, const Transports& known) {
  const Value* json = vendor.value("monitor", Need::optional);
  if (json == nullptr) return std::nullopt;
  ObjectReader reader(*json, vendor.path("monitor"), vendor.faults());
  Monitor monitor;
  monitor.protocol = read_name(reader, "protocol", Need::required, known, known.all_of(&Transport::monitors, {}));
  monitor.port = static_cast<std::uint16_t>(reader.integer("port", Need::required, 1, 65535).value_or(0));
  reader.refuse_unknown_keys();
  return monitor;
}

VendorCommands read_vendor(const Value& json, const std::string& name, const Transports& known,
                           const FileFaults& faults) {
  ObjectReader reader(json, name, faults);
  VendorCommands vendor;
  if (reader.value("port", Need::optional) != nullptr) {
    // A bad port counts as given: one mistake, one fault.
    vendor.port = static_cast<std::uint16_t>(reader.integer("port", Need::optional, 1, 65535).value_or(0));
  }
  vendor.transport = read_name(reader, "transport", Need::optional, known, known.names());
  const auto languages = known.all_of(&Transport::languages, {"plain"});
  vendor.language = read_name(reader, "language", Need::optional, known, languages, "plain");
  vendor.wrap = read_name(reader, "wrap", Need::optional, known, known.all_of(&Transport::wraps, {""}));
  const Value* wrap = reader.value("wrap", Need::optional);
  if (wrap != nullptr && wrap->is_text()) vendor.wrap = wrap->text();  // a bad one counts as given, too
  vendor.monitor = read_monitor(reader, known);
  vendor.values = read_words(reader, "values");
  vendor.commands = read_words(reader, "commands");
  vendor.requests = read_words(reader, "requests");
  read_own_keys(reader, known, vendor);
  if (!known.empty()) reader.refuse_unknown_keys();
  return vendor;
}

}  // namespace

AllCommands read_commands(const Value& json, const Transports& known, const FileFaults& faults) {
  AllCommands all;
  const ObjectReader reader(json, "", faults);
  if (!json.is_object() || !check_count(faults, "", json.object().size(), kMaxVendors)) return all;
  for (const auto& [name, vendor] : json.object()) all[name] = read_vendor(vendor, name, known, faults);
  return all;
}

}  // namespace trb
