#include "tools/app/study/sweep/sqlite.h"

#include <fmt/core.h>
#include <sqlite3.h>

#include <chrono>
#include <thread>

#include "sim/base/error.h"
#include "sim/base/interruption.h"

namespace leviosim::tools {
namespace {

/// For how long one process waits for another that writes.
constexpr std::chrono::milliseconds kBetweenTries{20};
constexpr int kMostTries = 3000;  // a minute

/// Statements that take this many steps of SQLite's machine look whether they are to stop.
constexpr int kStepsPerPoll = 100'000;

int try_again(void*, int tries) {
  if (tries >= kMostTries || pending_interrupt() != 0) return 0;
  std::this_thread::sleep_for(kBetweenTries);
  return 1;
}

int is_to_stop(void*) { return pending_interrupt(); }

}  // namespace

Database::Database(const std::filesystem::path& file, Mode mode) : file_(file.string()) {
  const int flags =
      mode == Mode::create ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READWRITE;
  if (sqlite3_open_v2(file_.c_str(), &handle_, flags, nullptr) != SQLITE_OK) {
    const std::string message = handle_ != nullptr ? sqlite3_errmsg(handle_) : "out of memory";
    sqlite3_close(handle_);
    throw InputError(fmt::format("{}: cannot be opened: {}", file_, message));
  }
  sqlite3_busy_handler(handle_, try_again, nullptr);
  sqlite3_progress_handler(handle_, kStepsPerPoll, is_to_stop, nullptr);
}

Database::~Database() { sqlite3_close(handle_); }

void Database::fail(std::string_view message) const {
  throw InputError(fmt::format("{}: {}", file_, message));
}

void Database::fail_with_reason() const {
  throw_if_interrupted();  // which SQLite takes for a fault
  fail(sqlite3_errmsg(handle_));
}

void Database::run(const std::string& sql) {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    fail_with_reason();
}

Statement::Statement(Database& database, const std::string& sql) : database_(database) {
  if (sqlite3_prepare_v2(database.handle_, sql.c_str(), -1, &handle_, nullptr) != SQLITE_OK)
    database.fail_with_reason();
}

Statement::~Statement() { sqlite3_finalize(handle_); }

Statement& Statement::bind(int place, std::int64_t value) {
  sqlite3_bind_int64(handle_, place, value);
  return *this;
}

Statement& Statement::bind(int place, std::optional<double> value) {
  if (value)
    sqlite3_bind_double(handle_, place, *value);
  else
    sqlite3_bind_null(handle_, place);
  return *this;
}

Statement& Statement::bind(int place, std::string_view value) {
  sqlite3_bind_text64(handle_, place, value.data(), value.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  return *this;
}

bool Statement::step() {
  const int result = sqlite3_step(handle_);
  if (result == SQLITE_ROW) return true;
  if (result != SQLITE_DONE) database_.fail_with_reason();
  return false;
}

void Statement::run() {
  step();
  reset();
}

void Statement::reset() {
  sqlite3_reset(handle_);
  sqlite3_clear_bindings(handle_);
}

std::int64_t Statement::whole(int column) const { return sqlite3_column_int64(handle_, column); }

std::optional<double> Statement::number(int column) const {
  if (sqlite3_column_type(handle_, column) == SQLITE_NULL) return std::nullopt;
  return sqlite3_column_double(handle_, column);
}

std::string Statement::text(int column) const {
  const unsigned char* const text = sqlite3_column_text(handle_, column);
  if (text == nullptr) return {};
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_column_bytes(handle_, column))};
}

void Statement::bind_column(int column, Statement& other) const {
  sqlite3_bind_value(other.handle_, column + 1, sqlite3_column_value(handle_, column));
}

Transaction::Transaction(Database& database) : database_(database) {
  database_.run("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.run("ROLLBACK");
  } catch (const std::exception&) {
    // SQLite has undone it already, as it does after faults of the disk, or will when it is closed.
  }
}

void Transaction::commit() {
  database_.run("COMMIT");
  open_ = false;
}

}  // namespace leviosim::tools
