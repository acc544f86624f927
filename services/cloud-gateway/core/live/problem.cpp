#include "services/cloud-gateway/core/live/problem.hpp"

#include <algorithm>
#include <array>

namespace trb::gateway {
namespace {

struct StatusRow {
  Errc code{};
  std::uint16_t status = 0;
};
using enum Errc;
constexpr std::array<StatusRow, 46> kStatuses{{
    {ok, 200},
    {malformed, 400},
    {unknown_key, 400},
    {missing, 400},
    {version_mismatch, 400},
    {not_permitted, 403},
    {source_mismatch, 403},
    {foreign_fleet, 403},
    {wrong_key, 403},
    {unknown_peer_key, 403},
    {cert_expired, 403},
    {cert_not_yet_valid, 403},
    {cert_revoked, 403},
    {bad_signature, 403},
    {unknown_target, 404},
    {unknown_run, 404},
    {unknown_skill, 404},
    {unknown_place, 404},
    {unknown_subtype, 404},
    {fenced, 409},
    {busy, 409},
    {out_of_use, 409},
    {control_held, 409},
    {already_claimed, 409},
    {stale_instance, 409},
    {conflict, 409},
    {duplicate, 409},
    {replayed, 409},
    {not_asked, 409},
    {too_large, 413},
    {bad_value, 422},
    {not_escapable, 422},
    {does_not_fit_figure_3, 422},
    {queue_full, 429},
    {io_error, 500},
    {robot_error, 502},
    {downgraded, 502},
    {seal_broken, 502},
    {peer_expired, 503},
    {peer_unreachable, 503},
    {no_service, 503},
    {no_field_channel, 503},
    {robot_offline, 503},
    {timeout, 504},
    {expired, 504},
    {not_confirmed, 504},
}};

std::string title_of(Errc code) {
  std::string out(errc_name(code));
  std::replace(out.begin(), out.end(), '_', ' ');
  return out;
}

Problem problem_of_code(Errc code) {
  return {"/api/v1/problems/" + std::string(errc_name(code)), title_of(code), status_of(code), {}, {}};
}

/// A scheduler's hint names a command of trb, which who speaks HTTP does not have.
std::string hint_over_http(const Error& error) {
  const bool names_trb = error.hint.find("trb ") != std::string::npos;
  if (error.code != Errc::unknown_run || !names_trb) return error.hint;
  return "GET /api/v1/runs has those that are open, GET /api/v1/archive those that are over";
}

/// True for "tasks[3].id"; false for plain words, header names and file names.
bool is_path(std::string_view text) {
  const auto is_part = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '[' || c == ']';
  };
  return !text.empty() && text[0] >= 'a' && text[0] <= 'z' && !text.ends_with(".json") &&
         std::all_of(text.begin(), text.end(), is_part);
}

}  // namespace

/// 0: missing in the table; a test finds that.
std::uint16_t status_of(Errc code) {
  const auto* at =
      std::find_if(kStatuses.begin(), kStatuses.end(), [&](const StatusRow& row) { return row.code == code; });
  return at == kStatuses.end() ? std::uint16_t{0} : at->status;
}

Problem problem_of(const Error& error) {
  Problem out = problem_of_code(error.code);
  out.detail = error.what;
  const std::string hint = hint_over_http(error);
  const std::size_t end = error.what.find(": ");
  if (end != std::string::npos && is_path(std::string_view(error.what).substr(0, end))) {
    out.errors.push_back({pointer_of(error.what.substr(0, end)), error.what.substr(end + 2), hint});
  } else {
    out.errors.push_back({{}, error.what, hint});
  }
  return out;
}

Problem problem_of(const ConfigFaults& faults, Errc code) {
  Problem out = problem_of_code(code);
  out.detail = faults.size() == 1 ? faults[0].what : std::to_string(faults.size()) + " faults";
  for (const ConfigFault& one : faults) out.errors.push_back({pointer_of(one.key), one.what, one.hint});
  return out;
}

std::string pointer_of(std::string_view path) {
  std::string out;
  if (!path.empty()) out += '/';
  for (const char c : path) {
    if (c == '~') {
      out += "~0";
    } else if (c == '/') {
      out += "~1";
    } else if (c == '.' || c == '[') {
      out += '/';
    } else if (c != ']') {
      out += c;
    }
  }
  return out;
}

}  // namespace trb::gateway
