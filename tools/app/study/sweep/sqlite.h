// As much of SQLite as sweeps need: statements with bound values, rows one after the other. Faults,
// such as a file that is no data base or a full disk, are InputErrors that name the file. Waiting
// for other processes and long statements end with Interrupted (sim/base/interruption.h).
//
// A data base may be a stranger's. SQLite would play back a journal beside it, and delete whatever
// file that names as its super-journal: a journal that names one, and whatever else beside the file
// would be opened but is none, is refused before SQLite sees it. Functions in its schema are not
// trusted, triggers do not run, values are bounded, and statements end after a number of steps that
// grows with the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace leviosim::tools {

class Database {
 public:
  enum class Mode {
    create,
    existing,
    read_only  ///< changes nothing, and refuses what a killed process left half-done
  };

  Database(const std::filesystem::path& file, Mode mode);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// Statements without values, separated by semicolons.
  void run(const std::string& sql);
  [[noreturn]] void fail(std::string_view message) const;
  /// With what SQLite says of the last statement. @throws Interrupted if that was stopped
  [[noreturn]] void fail_with_reason() const;

 private:
  friend class Statement;
  void confine();
  static int is_to_stop(void* database);

  std::string file_;
  sqlite3* handle_ = nullptr;
  std::uint64_t steps_ = 0;  ///< of SQLite's machine, in long statements
};

class Statement {
 public:
  Statement(Database& database, const std::string& sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// Values of the statement's question marks, from 1; reset() keeps none.
  Statement& bind(int place, std::int64_t value);
  Statement& bind(int place, std::optional<double> value);
  Statement& bind(int place, std::string_view value);
  /// The next row, if there is one.
  bool step();
  /// Runs a statement that has no rows, and makes it ready for other values.
  void run();
  void reset();

  std::int64_t whole(int column) const;
  std::optional<double> number(int column) const;
  std::string text(int column) const;
  /// Binds the value of a column, whatever its type, at the same place of another statement.
  void bind_column(int column, Statement& other) const;

 private:
  /// @param result  of SQLite; a value that memory lacks for would become NULL
  void expect_bound(int result) const;

  Database& database_;
  sqlite3_stmt* handle_ = nullptr;
};

/// All or nothing: what was written is undone unless commit() is reached. Others that write wait.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace leviosim::tools
