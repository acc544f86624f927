// A third party has the exported log and the fleet's public key, and nothing else.
#include "common/audit/audit_export.hpp"

#include <doctest/doctest.h>

#include "proto/body.hpp"

using namespace trb;

namespace {

/// A cloud's gateway with five records, the third and the fifth signed by its router.
struct Cloud {
  FleetAuthority authority;
  SigningKey node;
  SignedRecord certificate;
  AuditChain chain;
  std::vector<AuditRow> rows;
  std::vector<SignedRecord> heads;

  SigningKey root;

  Cloud() : chain(Bytes()) {
    init_crypto();
    root = make_signing_key();
    authority = {"hall", root.public_key};
    node = make_signing_key();
    certificate = certify("cloud", Role::cloud, node);
    chain = AuditChain(audit_start(authority.id(), "cloud"));
    for (int i = 1; i <= 5; ++i) {
      rows.push_back(chain.append({0, i, "ann \"quoted\"\n", "10.0.0.7", "POST /api/v1/stop", "arm", "done"}));
      if (i == 3 || i == 5) heads.push_back(sign_head(node));
    }
  }
  [[nodiscard]] SignedRecord certify(const std::string& id, Role role, const SigningKey& key) const {
    Certificate is;
    is.fleet = {authority.id()};
    is.serial = 7;
    is.id = id;
    is.role = role;
    is.identity_key = {key.public_key};
    is.link_key = {Bytes(32, 'l')};
    is.not_after = 1;  // long ago: the log is read later
    return sign(kSignedCertificate, "", authority.id(), encode(is), root);
  }
  [[nodiscard]] SignedRecord sign_head(const SigningKey& key) const {
    return sign(kSignedAuditHead, "cloud", authority.id(), audit_head_payload(chain.head({9})), key);
  }
  [[nodiscard]] std::string text() const {
    std::string out = audit_certificate_line(certificate);
    for (const AuditRow& row : rows) out += audit_line(row);
    for (const SignedRecord& head : heads) out += audit_head_line(head);
    return out;
  }
  [[nodiscard]] AuditCheck check() const {
    auto out = check_audit_export(text(), authority);
    REQUIRE(out.ok());
    return *out;
  }
};

Errc refusal(const std::string& text, const FleetAuthority& authority) {
  const auto out = check_audit_export(text, authority);
  return out ? Errc::ok : out.error().code;
}

}  // namespace

TEST_CASE("given the log as it was exported, then all of it is proven, and one knows whose it is") {
  const Cloud cloud;
  const AuditCheck check = cloud.check();
  CHECK_FALSE(check.report.fault);
  CHECK(check.node == "cloud");
  CHECK(check.records == 5);
  CHECK(check.report.covered == 5);
  CHECK(check.heads == 2);
}

TEST_CASE("given two pages that were joined, each with the certificate, then they are one log") {
  const Cloud cloud;
  CHECK(check_audit_export(audit_certificate_line(cloud.certificate) + "\n" + cloud.text(), cloud.authority).ok());
}

TEST_CASE("given two clouds' gateways that share one log, then the heads of both prove it, whichever exports it") {
  Cloud first;
  const SigningKey other = make_signing_key();
  first.rows.clear();
  first.chain = AuditChain(audit_start(first.authority.id(), "cloud"));
  for (int i = 1; i <= 2; ++i) first.rows.push_back(first.chain.append({0, i, "ann", "::1", "POST", "arm", "done"}));
  std::string log;
  for (const AuditRow& row : first.rows) log += audit_line(row);
  log += audit_head_line(first.sign_head(other));
  const std::string cloud = audit_certificate_line(first.certificate);
  const std::string second = audit_certificate_line(first.certify("second", Role::cloud, other));
  for (const std::string& text :
       {std::string(cloud).append(second).append(log), std::string(second).append(cloud).append(log)}) {
    const auto check = check_audit_export(text, first.authority);
    REQUIRE(check.ok());
    CHECK_FALSE(check->report.fault);
    CHECK(check->node == "cloud");
    CHECK(check->report.covered == 2);
  }
  const auto without = check_audit_export(cloud + log, first.authority);
  REQUIRE(without.ok());
  CHECK(without->other_heads == 1);
}

TEST_CASE("given a record was changed and all behind it hashed anew, then a signed head tells") {
  Cloud cloud;
  AuditChain again(audit_start(cloud.authority.id(), "cloud"));
  for (AuditRow& row : cloud.rows) {
    if (row.record.number == 2) row.record.who = "bob";
    row = again.append(row.record);
  }
  REQUIRE(cloud.check().report.fault);
  CHECK(cloud.check().report.fault->kind == AuditFaultKind::other_head);
}

TEST_CASE("given the last records were cut away, then a signed head tells how many there were") {
  Cloud cloud;
  cloud.rows.pop_back();
  REQUIRE(cloud.check().report.fault);
  CHECK(cloud.check().report.fault->kind == AuditFaultKind::truncated);
}

TEST_CASE("given a head that another key has signed, then it proves nothing and accuses nobody") {
  Cloud cloud;
  cloud.heads = {cloud.sign_head(make_signing_key())};
  const AuditCheck check = cloud.check();
  CHECK_FALSE(check.report.fault);
  CHECK(check.other_heads == 1);
  CHECK(check.report.covered == 0);
}

TEST_CASE("given a robot's certificate beside the cloud's, then what its key has signed proves nothing") {
  Cloud cloud;
  const SigningKey stolen = make_signing_key();
  const std::string robot = audit_certificate_line(cloud.certify("arm", Role::robot, stolen));
  SUBCASE("of the cloud's log") {
    cloud.heads = {cloud.sign_head(stolen)};
  }
  SUBCASE("of one that it has made up") {
    cloud.chain = AuditChain(audit_start(cloud.authority.id(), "arm"));
    cloud.rows = {cloud.chain.append({0, 1, "bob", "::1", "POST", "arm", "done"})};
    cloud.heads = {cloud.sign_head(stolen)};
  }
  for (const std::string& text : {robot + cloud.text(), cloud.text() + robot}) {
    const auto check = check_audit_export(text, cloud.authority);
    REQUIRE(check.ok());
    CHECK(check->node == "cloud");
    CHECK(check->heads == 0);
    CHECK(check->other_heads == 1);
    CHECK(check->report.covered == 0);
  }
  std::string alone = robot;
  for (const AuditRow& row : cloud.rows) alone += audit_line(row);
  CHECK(refusal(alone + audit_head_line(cloud.heads[0]), cloud.authority) == Errc::missing);
}

TEST_CASE("given another fleet's key, or no certificate, or lines that are none, then it is said") {
  const Cloud cloud;
  CHECK(refusal(cloud.text(), {"other", make_signing_key().public_key}) != Errc::ok);
  CHECK(refusal(audit_line(cloud.rows[0]), cloud.authority) == Errc::missing);
  for (const char* wrong :
       {"{", "{}", "{\"record\":{}}", "{\"record\":3,\"hash\":\"00\"}", "[1]", "{\"head\":\"x\"}"}) {
    CAPTURE(wrong);
    const auto out = check_audit_export(cloud.text() + wrong, cloud.authority);
    REQUIRE_FALSE(out.ok());
    CHECK(out.error().code == Errc::malformed);
    CHECK(out.error().what.find("line 9: ") == 0);
  }
}

TEST_CASE("two exports of one log: one goes on where the other ends, or they part, and it is told where") {
  Cloud cloud;
  const std::string early = cloud.text();
  Cloud restored = cloud;
  for (int i = 0; i < 2; ++i)
    cloud.rows.push_back(cloud.chain.append({0, 6, "bob", "10.0.0.8", "DELETE /api/v1/users/{user}", "eve", "done"}));
  const std::string late = cloud.text();
  const auto goes_on = find_parting(early, late);
  REQUIRE(goes_on.ok());
  CHECK_FALSE(*goes_on);

  restored.rows.push_back(
      restored.chain.append({0, 9'000'000'000, "console", "", std::string(kAuditRestored), "", "done"}));
  CHECK_FALSE(restored.check().report.fault);
  const auto parts = find_parting(late, restored.text());
  REQUIRE(parts.ok());
  REQUIRE(*parts);
  CHECK((*parts)->alike == 5);
  CHECK((*parts)->first->who == "bob");
  CHECK((*parts)->second->number == 9'000);
  CHECK_FALSE(find_parting("no line", late).ok());
}

TEST_CASE("pages of one log are joined, a second export of it is not") {
  const Cloud cloud;
  std::vector<std::string> pages;
  for (const AuditRow& row : cloud.rows) pages.push_back(audit_line(row));
  CHECK(join_exports(pages)->size() == 1);
  std::vector<std::string> both = pages;
  both.insert(both.end(), pages.begin(), pages.end());
  const auto joined = join_exports(both);
  REQUIRE(joined->size() == 2);
  CHECK(joined->at(0) == joined->at(1));
  CHECK_FALSE(join_exports({"no line"}).ok());
}
