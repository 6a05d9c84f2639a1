#include "tools/app/study/sweep/sweep_store.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/outputs/file_system.h"

namespace leviosim::tools {
namespace {

/// For how long one process waits for another that writes.
constexpr std::chrono::milliseconds kBetweenTries{20};
constexpr int kMostTries = 3000;  // a minute

/// Statements that take this many steps of SQLite's machine look whether they are to stop. Pages
/// that lead to each other hold more rows than the file has bytes.
constexpr int kStepsPerPoll = 10'000;
constexpr std::uint64_t kSteps = 10'000'000;
constexpr std::uint64_t kStepsPerByte = 100;

/// Of a text or a row; plans are at most a megabyte. [bytes]
constexpr int kLongestValue = 16 << 20;

int try_again(void*, int tries) {
  if (tries >= kMostTries || pending_interrupt() != 0) return 0;
  std::this_thread::sleep_for(kBetweenTries);
  return 1;
}

std::string bytes_at(const outputs::Descriptor& file, off_t place, std::size_t size) {
  std::string bytes(size, '\0');
  const ssize_t got = ::pread(file.get(), bytes.data(), size, place);
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return bytes;
}

/// What SQLite would open or play back unasked. @returns why it is not let to; empty if it may
std::string fault_beside(const std::string& file) {
  const std::optional<struct stat> base = outputs::status_of(file);
  if (!base) return {};
  if (!S_ISREG(base->st_mode) || base->st_nlink != 1)
    return "is no regular file with one name; expected the data base of a sweep";
  for (const char* end : {"-wal", "-shm"})
    if (outputs::status_of(file + end))
      return fmt::format("has {}{} beside it, which no sweep makes; remove it by hand", file, end);
  constexpr int kFlags = O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  const outputs::Descriptor data(::open(file.c_str(), kFlags));
  // File format, section 1.3.3: 1 is a rollback journal.
  const std::string versions = bytes_at(data, 18, 2);
  if (!versions.empty() && versions != "\1\1")
    return "has another journal than a sweep's, or is no data base; expected that of a sweep";
  const std::string journal = file + "-journal";
  const std::optional<struct stat> status = outputs::status_of(journal);
  if (!status) return {};
  const std::string by_hand = fmt::format("; if it is not yours, remove {}", journal);
  if (!S_ISREG(status->st_mode) || status->st_nlink != 1)
    return "has a journal that is no regular file with one name" + by_hand;
  // Section 3: a journal that ends with its magic number names another one before it.
  static constexpr std::string_view kMagic("\xd9\xd5\x05\xf9\x20\xa1\x63\xd7");
  const outputs::Descriptor opened(::open(journal.c_str(), kFlags));
  if (!opened && errno == ENOENT) return {};  // another process is done
  if (!opened) return "has a journal that cannot be read" + by_hand;
  if (status->st_size >= 8 && bytes_at(opened, status->st_size - 8, 8) == kMagic)
    return "has a journal that names another file, which no sweep writes" + by_hand;
  return {};
}

int flags_of(Database::Mode mode) {
  if (mode == Database::Mode::read_only) return SQLITE_OPEN_READONLY;
  return SQLITE_OPEN_READWRITE | (mode == Database::Mode::create ? SQLITE_OPEN_CREATE : 0);
}

}  // namespace

Database::Database(const std::filesystem::path& file, Mode mode) {
  std::error_code error;
  file_ = std::filesystem::weakly_canonical(file, error).string();  // as SQLite finds the journal
  if (error) throw InputError(fmt::format("{}: {}", file.string(), error.message()));
  if (const std::string fault = fault_beside(file_); !fault.empty()) fail(fault);
  if (sqlite3_open_v2(file_.c_str(), &handle_, flags_of(mode), nullptr) != SQLITE_OK) {
    const std::string message = handle_ != nullptr ? sqlite3_errmsg(handle_) : "out of memory";
    sqlite3_close(handle_);
    throw InputError(fmt::format("{}: cannot be opened: {}", file_, message));
  }
  confine();
}

void Database::confine() {
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_limit(handle_, SQLITE_LIMIT_LENGTH, kLongestValue);
  sqlite3_limit(handle_, SQLITE_LIMIT_ATTACHED, 0);
  sqlite3_busy_handler(handle_, try_again, nullptr);
  sqlite3_progress_handler(handle_, kStepsPerPoll, is_to_stop, this);
}

int Database::is_to_stop(void* database) {
  Database& self = *static_cast<Database*>(database);
  const std::optional<struct stat> status = outputs::status_of(self.file_);
  const std::uint64_t size = status ? static_cast<std::uint64_t>(status->st_size) : 0;
  self.steps_ += kStepsPerPoll;
  return pending_interrupt() != 0 || self.steps_ > kSteps + kStepsPerByte * size ? 1 : 0;
}

Database::~Database() { sqlite3_close(handle_); }

void Database::fail(std::string_view message) const {
  throw InputError(fmt::format("{}: {}", file_, message));
}

void Database::fail_with_reason() const {
  throw_if_interrupted();  // which SQLite takes for a fault
  if (sqlite3_errcode(handle_) == SQLITE_INTERRUPT)
    fail("takes more steps to read than a file of its size may; it is damaged or no sweep's");
  if (sqlite3_extended_errcode(handle_) == SQLITE_READONLY_ROLLBACK)
    fail("a process was stopped while it wrote; run the sweep again, which puts that in order");
  fail(sqlite3_errmsg(handle_));
}

void Database::run(const std::string& sql) {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    fail_with_reason();
}

void Database::rewrite() {
  sqlite3_limit(handle_, SQLITE_LIMIT_ATTACHED, 1);  // the copy that VACUUM makes
  run("PRAGMA temp_store = MEMORY; VACUUM");
  sqlite3_limit(handle_, SQLITE_LIMIT_ATTACHED, 0);
}

Statement::Statement(Database& database, const std::string& sql) : database_(database) {
  if (sqlite3_prepare_v2(database.handle_, sql.c_str(), -1, &handle_, nullptr) != SQLITE_OK)
    database.fail_with_reason();
}

Statement::~Statement() { sqlite3_finalize(handle_); }

void Statement::expect_bound(int result) const {
  if (result != SQLITE_OK) database_.fail_with_reason();
}

Statement& Statement::bind(int place, std::int64_t value) {
  expect_bound(sqlite3_bind_int64(handle_, place, value));
  return *this;
}

Statement& Statement::bind(int place, std::optional<double> value) {
  expect_bound(value ? sqlite3_bind_double(handle_, place, *value)
                     : sqlite3_bind_null(handle_, place));
  return *this;
}

Statement& Statement::bind(int place, std::string_view value) {
  expect_bound(sqlite3_bind_text64(handle_, place, value.data(), value.size(), SQLITE_TRANSIENT,
                                   SQLITE_UTF8));
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
  if (sqlite3_column_type(handle_, column) == SQLITE_NULL) return {};
  const unsigned char* const text = sqlite3_column_text(handle_, column);
  if (text == nullptr) database_.fail_with_reason();
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_column_bytes(handle_, column))};
}

void Statement::bind_column(int column, Statement& other) const {
  other.expect_bound(
      sqlite3_bind_value(other.handle_, column + 1, sqlite3_column_value(handle_, column)));
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
