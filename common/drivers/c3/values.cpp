#include "common/drivers/c3/values.hpp"

#include <algorithm>

#include "common/drivers/c3/krl.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxRequests = 64;

}  // namespace

Status C3Values::ask(const Handover& request, Now now, const DriverOut& out) {
  const std::string& name = requests_.find(request.subtype)->second;
  const auto question = std::ranges::find(questions_, name, &Question::name);
  if (question == questions_.end()) return fail(Errc::unknown_subtype, "commands.json has no value '" + name + "'");
  if (asked_.size() >= kMaxRequests) return fail(Errc::queue_full, "64 requests wait already", "ask less often");
  link_.request({C3Purpose::request, question->words.variable, std::nullopt, request.token}, now, out);
  out.out.count("to_robot." + std::string(request.subtype));
  asked_.emplace(request.token, Asked{std::string(request.subtype), std::string(request.source), question->words});
  return Done{};
}

void C3Values::poll(Now now, const DriverOut& out) {
  for (std::size_t i = 0; i < questions_.size(); ++i) {
    link_.ask({C3Purpose::value, questions_[i].words.variable, std::nullopt, i}, now, out);
  }
}

void C3Values::on_value(const C3Link::Answer& answer, Now now, const DriverOut& out) {
  if (!answer.reply.ok || answer.ask.about >= questions_.size()) return;
  const Question& question = questions_[answer.ask.about];
  auto value = read_krl(answer.reply.value, question.words.components);
  if (!value) {
    if (told_bad_.insert(question.name).second) out.refuse("bad_value", question.name + ": " + value.error().text());
    return;
  }
  values_[question.name] = RobotValue{std::move(value->numbers), std::move(value->json), now.mono};
  out.emit(ValuesHeard{});
}

void C3Values::on_request(const C3Link::Answer& answer, const DriverOut& out) {
  const Token token = answer.ask.about;
  const auto found = asked_.find(token);
  if (found == asked_.end()) return out.out.count("refused.late_answer");
  const Asked asked = std::move(found->second);
  asked_.erase(found);
  if (!answer.reply.ok) return out.emit(Refused{token, refused_by_robot(answer)});
  auto value = read_krl(answer.reply.value, asked.words.components);
  if (!value) return out.emit(Refused{token, value.error()});
  out.out.count("from_robot." + asked.subtype);
  out.emit(Said{MessageType::information, asked.subtype, asked.source, std::move(value->json)});
}

}  // namespace trb::drivers
