#include "common/operator/reload_service.hpp"

#include <algorithm>
#include <memory>

namespace trb::op {
namespace {

constexpr Duration kLookAgain = std::chrono::milliseconds(100);

struct Reloading {
  Session& session;
  ReloadService order;
  Callback<ServiceEntry> done;
  MonotonicTime until;
  std::uint64_t before = 0;  ///< the instance that was asked; 0: none was up
  bool asked = false;
};
using ReloadingPtr = std::shared_ptr<Reloading>;

const ServiceEntry* entry_in(const ServiceTable& table, const std::string& service) {
  const auto at = std::ranges::find(table.services, service, &ServiceEntry::service);
  return at == table.services.end() ? nullptr : &*at;
}

bool is_down(const ServiceEntry& entry) {
  return entry.state == "down";
}

void look(const ReloadingPtr& reloading);

void look_again(const ReloadingPtr& reloading) {
  if (reloading->session.now().mono < reloading->until) {
    return reloading->session.after(kLookAgain, [reloading] { look(reloading); });
  }
  reloading->done(fail(Errc::timeout, reloading->order.service + " has not come back with its new files",
                       "see its log: trb logs NODE_DIR"));
}

void ask(const ReloadingPtr& reloading, const ServiceEntry* entry) {
  if (entry == nullptr) {
    return reloading->done(fail(Errc::no_service,
                                "'" + reloading->session.node() + "' has no " + reloading->order.service,
                                "put it into \"services\" of node.json, then trb reload"));
  }
  reloading->asked = true;
  if (!is_down(*entry)) {
    reloading->before = entry->instance;
    const Status told = reloading->order.ask(entry->pid);
    if (!told && told.error().code != Errc::missing) return reloading->done(told.error());
  }
  look_again(reloading);
}

void on_table(const ReloadingPtr& reloading, const ServiceTable& table) {
  const ServiceEntry* entry = entry_in(table, reloading->order.service);
  if (!reloading->asked) return ask(reloading, entry);
  if (entry != nullptr && entry->state == "up" && entry->instance != reloading->before) {
    return reloading->done(*entry);
  }
  look_again(reloading);
}

void look(const ReloadingPtr& reloading) {
  const auto take = [reloading](const ServiceTable& table) { on_table(reloading, table); };
  reloading->session.ask_node<ServiceTable>(ServiceListRequest{}, on_success<ServiceTable>(reloading->done, take));
}

}  // namespace

void reload_service(Session& session, ReloadService order, Callback<ServiceEntry> done) {
  const MonotonicTime until = session.now().mono + order.wait;
  look(std::make_shared<Reloading>(Reloading{session, std::move(order), std::move(done), until}));
}

}  // namespace trb::op
