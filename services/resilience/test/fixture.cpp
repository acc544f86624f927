#include "services/resilience/test/fixture.hpp"

#include <stdlib.h>

#include <algorithm>
#include <filesystem>

namespace trb::resilience::test {

Fixture::Fixture(ResilienceSettings resilience, Role role)
    : settings{"cloud", role, resilience, {{"dock", {0, 0}}, {"table1", {4, 0}}}} {
  init_crypto();
  authority_key_ = make_signing_key();
  authority_ = {"test", authority_key_.public_key};
  key_ = make_signing_key();
  open();
}

Fixture::~Fixture() {
  process_.reset();
  steps_.reset();
  core_.reset();
  db_.reset();
}

void Fixture::open() {
  auto db = CapabilityDb::open(folder_.path + "/capability.db");
  REQUIRE_MESSAGE(db.ok(), (db ? "" : db.error().text()));
  db_ = std::move(*db);
  core_ = std::make_unique<ResilienceCore>(settings, db_.get());
  const Status restored = trb::resilience::restore(*db_, *core_);
  REQUIRE_MESSAGE(restored.ok(), (restored ? "" : restored.error().text()));
  steps_ = std::make_unique<RecordingCore>(*core_, *db_);
  world::ProcessSettings process;
  process.store = [this](const std::vector<Journal>& records) { store(records); };
  process.send = [this](const Send& send) { handle(send); };
  process.crash = &crash;
  process.on_crash = [this] { restart(); };
  process_ = std::make_unique<world::CoreProcess>(std::move(process), *steps_, events_, clock_);
  bus_ = std::make_shared<char>();
  process_->welcome({"cloud", settings.role, 1});
}

void Fixture::restart() {
  bus_.reset();
  process_.reset();
  steps_.reset();
  core_.reset();
  db_.reset();
  watched_ = false;
  open();
}

SignedRecord Fixture::sign(std::string_view purpose, Bytes payload) const {
  return trb::sign(purpose, "cloud", authority_.id(), std::move(payload), key_);
}

SignedRecord Fixture::certificate(const std::string& id, Role role, std::uint64_t serial, const Bytes& key) const {
  Certificate of;
  of.serial = serial;
  of.id = id;
  of.role = role;
  of.identity_key.bytes = key;
  return trb::sign(kSignedCertificate, "", authority_.id(), encode(of), authority_key_);
}

// ---- the loop

void Fixture::post(Inbound message) {
  events_.after({}, bus_, [this, message = std::move(message)] { process_->take(message); });
}

void Fixture::store(const std::vector<Journal>& records) {
  const Status done = commit(*db_, records);
  REQUIRE_MESSAGE(done.ok(), (done ? "" : done.error().text()));
}

void Fixture::settle() {
  constexpr int kMost = 10'000;
  int steps = 0;
  while (events_.step(events_.now())) REQUIRE_MESSAGE(++steps < kMost, "the core never comes to rest");
}

void Fixture::wait(Duration time) {
  const MonotonicTime end = events_.now() + time;
  while (events_.step(end)) {
  }
}

void Fixture::put_clock(double ahead_s) {
  clock_.set({.ahead_s = ahead_s});
}

void Fixture::answer(const std::string& from, Body body) {
  post({MessageType::information, from, "cloud", ++count_, 1, 0, 1000, std::move(body)});
}

void Fixture::nack(const Send& send, const std::string& from, const std::string& code, const std::string& what,
                   const std::string& about) {
  answer(from, Nack{code, std::string(subtype_of(send.body)), send.target, what, "", about});
}

void Fixture::handle(const Send& sent) {
  auto body = decode_body(subtype_of(sent.body), encode_body(sent.body));
  REQUIRE_MESSAGE(body.ok(), (body ? "" : body.error().text()));
  Send send = sent;
  send.body = std::move(*body);
  ++heard[std::string(subtype_of(send.body))];
  if (send.reply_to != 0) {
    if (send.reply_to == asked_) told_ = send.body;
    return;
  }
  if (send.target == "cloud") return handle_own(send);
  const auto route = routes.find(send.target);
  REQUIRE(route != routes.end());
  if (route->second.state != "ONLINE") return nack(send, "cloud", "peer_expired", "not there");
  if (const auto* question = get_if<Opaque>(&send.body)) {
    if (mute.contains(send.target)) return;
    const auto& known = values[send.target];
    const auto value = known.find(question->subtype);
    if (value == known.end()) return nack(send, send.target, "unknown_subtype", "not told");
    return answer(send.target, Opaque{value->first, value->second});
  }
  if (const auto* read = get_if<SensorRead>(&send.body)) {
    const auto& known = readings[send.target];
    const auto reading = known.find(read->sensor);
    const std::string about = names_sensor ? read->sensor : "";
    if (reading == known.end()) return nack(send, send.target, "unknown_target", "no sensor " + read->sensor, about);
    if (reading->second) answer(send.target, *reading->second);
    return;
  }
  if (const auto* repaired = get_if<TakeIntoUse>(&send.body)) return take_into_use(send, *repaired);
  const auto* order = get_if<ReleaseTasks>(&send.body);
  REQUIRE(order != nullptr);
  release(send.target, *order);
}

void Fixture::handle_own(const Send& send) {
  if (const auto* asked = get_if<RouteListRequest>(&send.body)) {
    if (no_table) return;
    RouteTable table{"cloud", {}, false, asked->after};
    table.routes.reserve(std::min(page, routes.size()));
    for (auto at = routes.upper_bound(asked->after); at != routes.end(); ++at) {
      table.more = table.routes.size() == page;
      if (table.more) break;
      table.routes.push_back(at->second);
    }
    return answer("cloud", std::move(table));
  }
  if (const auto* request = get_if<SignRequest>(&send.body)) {
    return answer("cloud", sign(request->kind, request->payload.bytes));
  }
  if (deaf) return;
  if (holds_alternative<RunWatch>(send.body)) {
    if (!knows_watch) return nack(send, "cloud", "no_service", "nobody takes it");
    watched_ = true;
    RunTable table;
    const bool archived = view.state == RunState::expired;
    if (!view.run.empty() && !archived) {
      table.runs.push_back(summary());
    }
    return answer("cloud", table);
  }
  if (holds_alternative<RunQuery>(send.body)) return answer("cloud", view);
  if (holds_alternative<NeedDefinition>(send.body)) {
    return answer("cloud", Definition{sign(kSignedRunStart, encode(start)), decisions});
  }
  if (const auto* decision = get_if<RunDecision>(&send.body)) {
    if (!refuses.empty()) return nack(send, "cloud", refuses, "the test says so");
    const Status good = take(decision->decision);
    CHECK_MESSAGE(good.ok(), (good ? "" : good.error().text()));
    if (!good) return nack(send, "cloud", "bad_value", good.error().what);
    return answer("cloud", Ack{"accepted", ""});
  }
  if (holds_alternative<RunAbort>(send.body)) {
    view.state = RunState::aborted;
    answer("cloud", Ack{"accepted", ""});
    return changed();
  }
  FAIL("the core says ", std::string(subtype_of(send.body)));
}

// ---- people

Body Fixture::ask(Body question) {
  asked_ = 1'000'000 + ++count_;
  told_.reset();
  post({MessageType::request, "cloud", "cloud", asked_, 0, 0, 1000, std::move(question)});
  settle();
  REQUIRE(told_);
  return *told_;
}

std::vector<Alert> Fixture::alerts(bool all) {
  return get<AlertTable>(ask(AlertListRequest{all})).alerts;
}

Alert Fixture::alert() {
  const auto open = alerts();
  REQUIRE(open.size() == 1);
  return open.front();
}

std::vector<Alert> Fixture::run_alerts() {
  auto open = alerts();
  std::erase_if(open, [](const Alert& one) { return one.run.empty(); });
  return open;
}

Alert Fixture::run_alert() {
  const auto open = run_alerts();
  REQUIRE(open.size() == 1);
  return open.front();
}

Alert Fixture::any(const std::string& id) {
  for (const Alert& one : alerts(true)) {
    if (one.id == id) return one;
  }
  FAIL("no alert ", id);
  return {};
}

std::string Fixture::decide(AlertDecide verdict, const std::string& from) {
  asked_ = 1'000'000 + ++count_;
  told_.reset();
  verdict.person = "ann";
  post({MessageType::command, from, "cloud", asked_, 0, 0, 1000, verdict});
  settle();
  if (!told_) return "lost";
  if (const auto* ack = get_if<Ack>(&*told_)) {
    last_text = ack->text;
    return ack->state;
  }
  last_text = get<Nack>(*told_).what + " | " + get<Nack>(*told_).hint;
  return get<Nack>(*told_).code;
}

std::string Fixture::decide(Verdict verdict, const std::string& robot, bool stands, const std::string& reason) {
  const auto of_runs = run_alerts();
  return decide(AlertDecide{of_runs.size() == 1 ? of_runs.front().id : alert().id, verdict, robot, "", reason, stands});
}

}  // namespace trb::resilience::test
