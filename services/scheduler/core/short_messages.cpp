#include "services/scheduler/core/short_messages.hpp"

#include "services/scheduler/core/refusal.hpp"
#include "services/scheduler/core/run/short_form.hpp"

namespace trb::scheduler {
namespace {

const Blob* short_form_of(const Body& body) {
  if (const auto* baton = get_if<Baton>(&body)) return &baton->short_form;
  if (const auto* results = get_if<Results>(&body)) return &results->short_form;
  return nullptr;
}

Result<Body> long_body(const Body& body, const RunDefinition& definition) {
  if (const auto* baton = get_if<Baton>(&body)) {
    auto out = lengthened(*baton, definition);
    return out ? Result<Body>(Body{std::move(*out)}) : Result<Body>(out.error());
  }
  auto out = lengthened(get<Results>(body), definition);
  return out ? Result<Body>(Body{std::move(*out)}) : Result<Body>(out.error());
}

}  // namespace

bool is_short(const Body& body) {
  const Blob* form = short_form_of(body);
  return form != nullptr && !form->bytes.empty();
}

std::optional<Inbound> lengthened(const Inbound& message, const RunStore& runs, Step step) {
  const Run* run = runs.find_by_tag(tag_of(*short_form_of(message.body)));
  // A stranger learns nothing of a run.
  if (run == nullptr || !run->members().contains(message.source)) {
    step.out.count("short_form.unknown_run");
    return std::nullopt;
  }
  auto body = long_body(message.body, run->definition());
  if (!body) {
    refuse(message, body.error(), step);
    return std::nullopt;
  }
  Inbound out = message;
  out.body = std::move(*body);
  return out;
}

}  // namespace trb::scheduler
