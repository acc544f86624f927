#include <sqlite3.h>

#include <stdexcept>

#include "tests/bench/capability/hall.hpp"

namespace trb::bench {
namespace {

/// Robots that have all of the skills, ascending, as a person who knows SQLite would write it.
std::string sql_of(Database::Question question) {
  std::string sql;
  if (question == Database::kGroup) {
    return "SELECT robot FROM has JOIN robots ON robots.id = has.robot WHERE skill IN (?1,?2,?3,?4,?5,?6,?7,?8) "
           "AND fit GROUP BY robot HAVING count(*) = 8 ORDER BY robot";
  }
  if (question == Database::kIntersect) {
    for (std::size_t i = 1; i <= kAsked; ++i)
      sql += "SELECT robot FROM has WHERE skill = ?" + std::to_string(i) + " INTERSECT ";
    return sql + "SELECT id FROM robots WHERE fit ORDER BY robot";
  }
  sql = "SELECT h1.robot FROM has h1";
  for (std::size_t i = 2; i <= kAsked; ++i) {
    const std::string n = std::to_string(i);
    sql += " JOIN has h" + n + " ON h" + n + ".skill = ?" + n + " AND h" + n + ".robot = h1.robot";
  }
  return sql + " JOIN robots ON robots.id = h1.robot WHERE h1.skill = ?1 AND fit ORDER BY h1.robot";
}

}  // namespace

Database::Database(const Hall& hall) {
  if (sqlite3_open(":memory:", &db_) != SQLITE_OK) throw std::runtime_error("SQLite cannot be opened");
  run("CREATE TABLE robots(id INTEGER PRIMARY KEY, fit INTEGER NOT NULL)");
  run("CREATE TABLE has(skill INTEGER NOT NULL, robot INTEGER NOT NULL, PRIMARY KEY(skill, robot)) WITHOUT ROWID");
  fill(hall);
  run("ANALYZE");
  for (const Question question : {kGroup, kIntersect, kJoin}) questions_[question] = prepare(sql_of(question));
}

Database::~Database() {
  for (sqlite3_stmt* question : questions_) sqlite3_finalize(question);
  sqlite3_close(db_);
}

void Database::run(const char* sql) {
  if (sqlite3_exec(db_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) throw std::runtime_error(sqlite3_errmsg(db_));
}

sqlite3_stmt* Database::prepare(const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(db_, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) {
    throw std::runtime_error(sqlite3_errmsg(db_));
  }
  return statement;
}

/// In the order of the table, so that the table becomes compact.
void Database::fill(const Hall& hall) {
  std::vector<std::vector<std::uint32_t>> robots(kSkills);
  for (std::size_t i = 0; i < hall.size(); ++i) {
    for (const std::uint32_t skill : hall.skills_of(i)) robots[skill].push_back(static_cast<std::uint32_t>(i));
  }
  run("BEGIN");
  sqlite3_stmt* insert = prepare("INSERT INTO robots VALUES(?, 1)");
  for (std::size_t i = 0; i < hall.size(); ++i) {
    sqlite3_bind_int64(insert, 1, static_cast<std::int64_t>(i));
    sqlite3_step(insert);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  insert = prepare("INSERT INTO has VALUES(?, ?)");
  for (std::size_t skill = 0; skill < kSkills; ++skill) {
    for (const std::uint32_t robot : robots[skill]) {
      sqlite3_bind_int64(insert, 1, static_cast<std::int64_t>(skill));
      sqlite3_bind_int64(insert, 2, robot);
      sqlite3_step(insert);
      sqlite3_reset(insert);
    }
  }
  sqlite3_finalize(insert);
  run("COMMIT");
}

void Database::ask(Question question, const Skills& asked, std::vector<resilience::RobotNumber>& out) {
  out.clear();
  sqlite3_stmt* statement = questions_[question];
  for (std::size_t i = 0; i < asked.size(); ++i)
    sqlite3_bind_int(statement, static_cast<int>(i) + 1, static_cast<int>(asked[i]));
  while (sqlite3_step(statement) == SQLITE_ROW) {
    out.push_back(static_cast<resilience::RobotNumber>(sqlite3_column_int64(statement, 0)));
  }
  sqlite3_reset(statement);
}

}  // namespace trb::bench
