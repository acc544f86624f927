#include "services/scheduler/core/journal_records.hpp"

#include <algorithm>
#include <array>

#include "proto/make_shape.hpp"

namespace trb::scheduler {
namespace {

/// What SQLite puts into a row. The archive of a run has all of its results, together more than a message takes.
constexpr DecodeLimits kOfRow{.bytes = 1'000'000'000};

/// A kind of record, without its type.
struct Kind {
  std::string_view name;
  Result<JournalRecord> (*decode)(BytesView bytes);
  std::optional<JournalRecord> (*take)(const std::any& recorded);
};

template <class T>
Result<JournalRecord> decode_as(BytesView bytes) {
  T out{};
  const Error error = unpack(make_shape<T>(), bytes, &out, kOfRow);
  if (error.code != Errc::ok) return fail(error.code, std::string(T::kKind) + ": " + error.what);
  return JournalRecord(std::move(out));
}

template <class T>
std::optional<JournalRecord> take_as(const std::any& recorded) {
  const T* is = std::any_cast<T>(&recorded);
  return is == nullptr ? std::nullopt : std::optional<JournalRecord>(*is);
}

template <class... Records>
constexpr std::array<Kind, sizeof...(Records)> kinds_in(std::type_identity<std::variant<Records...>>) {
  return {Kind{Records::kKind, &decode_as<Records>, &take_as<Records>}...};
}

constexpr auto kKinds = kinds_in(std::type_identity<JournalRecord>{});

}  // namespace

std::string_view kind_of(const JournalRecord& record) {
  return kKinds[record.index()].name;
}

Bytes encode_record(const JournalRecord& record) {
  return std::visit([](const auto& is) { return pack(make_shape<std::decay_t<decltype(is)>>(), &is); }, record);
}

Result<JournalRecord> decode_record(std::string_view kind, BytesView bytes) {
  const auto* at = std::ranges::find(kKinds, kind, &Kind::name);
  if (at == kKinds.end()) return fail(Errc::bad_value, "'" + std::string(kind) + "' is no journal record");
  return at->decode(bytes);
}

Result<JournalRecord> to_journal_record(const std::any& recorded) {
  for (const Kind& kind : kKinds) {
    if (auto record = kind.take(recorded)) return std::move(*record);
  }
  return fail(Errc::bad_value, "what was recorded is no journal record");
}

Result<std::string> run_of(const JournalRecord& record) {
  using Id = Result<std::string>;
  return std::visit(
      Overloaded{
          [](const JournalRun& is) { return run_inside<RunStart>(is.start); },
          [](const JournalStart& is) { return Id(is.key.run); },
          [](const JournalResult& is) { return run_inside<TaskResult>(is.result); },
          [](const JournalChoice& is) { return run_inside<Choice>(is.choice); },
          [](const JournalDelivered& is) { return Id(is.run); },
          [](const JournalAbort& is) { return run_inside<AbortOrder>(is.order); },
          [](const JournalDecision& is) { return run_inside<Decision>(is.decision); },
          [](const JournalPause& is) { return run_inside<PauseOrder>(is.order); },
          [](const JournalEnd& is) { return run_inside<RunEnd>(is.end); },
          [](const JournalArchive& is) { return Id(is.view.run); },
          [](const JournalTime&) { return Id(std::string()); },
          [](const JournalLost&) { return Id(std::string()); },
          [](const JournalTombstone& is) {
            return Id(fail(Errc::bad_value, "'" + std::string(is.kKind) + "' is no journal record any more"));
          },
      },
      record);
}

}  // namespace trb::scheduler
