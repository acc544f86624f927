#include "common/drivers/http-json/commands.hpp"

#include <set>

#include "common/drivers/http-json/keys.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

/// One vendor's part of commands.json.
class Reader {
 public:
  Reader(const VendorCommands& vendor, const VendorFaults& faults) : body_(http_body(vendor)), faults_(faults) {}

  HttpCommands read(const VendorCommands& vendor) {
    for (const auto& [subtype, words] : vendor.commands) command(subtype, words);
    for (const auto& [name, words] : vendor.values) value(name, words);
    sign_out(http_sign_out(vendor));
    for (const auto& [subtype, lines] : out_.commands) {
      for (const HttpCall& one : lines) check_names("commands." + subtype, one.path);
    }
    return std::move(out_);
  }

 private:
  void command(const std::string& subtype, const std::string& words) {
    const std::string key = "commands." + subtype;
    auto read = read_http_calls(words, body_);
    if (!read) return faults_.add(key, read.error());
    if (read->empty() && !words.empty()) faults_.add(key, "is blank", "write METHOD PATH [JSON], a line each");
    for (const HttpCall& one : *read) {
      if (!one.remembers.empty()) remembered_.insert(one.remembers);
      if (needs_data(one) && (subtype == "stop" || subtype == "release")) {
        faults_.add(key, "needs data, and a " + subtype + " has none", "write the values themselves");
      }
    }
    out_.commands.emplace(subtype, std::move(*read));
  }

  void value(const std::string& name, const std::string& words) {
    auto read = read_http_question(words);
    if (!read) return faults_.add("values." + name, read.error());
    check_names("values." + name, read->path);
    if (read->path.needs_data()) {
      faults_.add("values." + name, "needs data, and a value has none",
                  "write the path itself, or <NAME> for what a command's answer tells");
    }
    out_.values.emplace(name, std::move(*read));
  }

  void sign_out(const std::string& words) {
    if (words.empty()) return;
    auto read = read_http_calls(words, body_);
    if (!read) return faults_.add("sign_out", read.error());
    if (read->size() != 1 || needs_data(read->front()) || !read->front().path.names().empty()) {
      return faults_.add("sign_out", "is not one request without data", "write it as \"GET /logout\"");
    }
    out_.sign_out = std::move(read->front());
  }

  [[nodiscard]] bool needs_data(const HttpCall& one) const {
    return one.path.needs_data() || (one.body && !one.body->fill("", http_literal(body_)).ok());
  }

  /// Some command's answer must provide what a path needs.
  void check_names(const std::string& key, const HttpPath& path) const {
    for (const std::string& name : path.names()) {
      if (remembered_.contains(name)) continue;
      faults_.add(key, "needs <" + name + ">, which no command's answer tells",
                  did_you_mean(name, {remembered_.begin(), remembered_.end()},
                               "let a command end with -> " + name + " /POINTER, or use one of"));
    }
  }

  HttpBody body_;
  const VendorFaults& faults_;
  HttpCommands out_;
  std::set<std::string> remembered_;
};

}  // namespace

HttpCommands read_http_commands(const VendorCommands& vendor, const Description&, const VendorFaults& faults) {
  return Reader(vendor, faults).read(vendor);
}

}  // namespace trb::drivers
