// Tables of values separated by commas or blanks.
//
// Reading (EuRoC's data.csv, TUM trajectories) goes row by row.
// Every fault is an InputError that names file, line and column. Lines that begin with '#' are
// comments; CRLF line ends, a byte-order mark and blank lines at the end of the file are accepted.
// Left out: quoting and escapes, which none of these formats has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::base {

/// "FILE line N", the way every message of this folder names a place.
std::string at_line(const std::filesystem::path& file, std::size_t line);

/// The whole file. Throws InputError if it cannot be read.
std::string read_text_file(const std::filesystem::path& file);

/// The number that `text` spells completely and that is finite; false otherwise. Independent of the
/// locale.
bool parse_number(std::string_view text, double& value);

/// One data row; cells are trimmed of blanks. Valid until the reader moves on.
class CsvRow {
 public:
  std::size_t line() const { return line_; }
  std::size_t size() const { return cells_.size(); }
  std::string_view text(std::size_t column) const { return cells_[column]; }

  /// A finite number, or InputError.
  double number(std::size_t column) const;
  /// Nanoseconds as a non-negative integer, or InputError.
  std::int64_t nanoseconds(std::size_t column) const;
  /// Nanoseconds from seconds, 0 to 9e9, or InputError. Plain decimals are exact, and digits beyond
  /// the ninth dropped; scientific notation is as exact as a double is.
  std::int64_t nanoseconds_from_seconds(std::size_t column) const;
  /// Throws an InputError about this row.
  [[noreturn]] void fail(std::string_view message) const;
  /// Throws an InputError about one cell: "..., column 2 (name): 'text' is MESSAGE".
  [[noreturn]] void fail(std::size_t column, std::string_view message) const;

 private:
  friend class CsvReader;
  const std::filesystem::path* file_ = nullptr;
  const std::vector<std::string>* names_ = nullptr;
  std::size_t line_ = 0;
  std::vector<std::string_view> cells_;
};

enum class Separator { comma, blanks };

/// What the first row of a file looks like: separated by commas if it holds one.
struct FirstRow {
  Separator separator = Separator::blanks;
  std::size_t columns = 0;
  std::size_t line = 0;
};

/// Throws InputError if the file cannot be read or has no row.
FirstRow first_row(const std::filesystem::path& file);

/// Reads a file whose rows have `names.size()` columns (the names appear in messages only).
class CsvReader {
 public:
  CsvReader(std::filesystem::path file, Separator separator, std::vector<std::string> names);
  /// Reads a table from text that is at hand; `file` is its name for messages.
  CsvReader(std::filesystem::path file, Separator separator, std::vector<std::string> names,
            std::string text);
  CsvReader(const CsvReader&) = delete;
  CsvReader& operator=(const CsvReader&) = delete;

  /// The cells of the first line without its '#', if it begins with one; else none. To be asked
  /// before the first row, and valid until then.
  std::vector<std::string_view> heading();
  /// The next row, or nullptr at the end. Throws InputError for a row of another width.
  const CsvRow* next();
  const std::filesystem::path& file() const { return file_; }

 private:
  friend FirstRow first_row(const std::filesystem::path& file);
  bool advance();
  std::string_view next_line();
  void split(std::string_view line);

  std::filesystem::path file_;
  Separator separator_;
  std::vector<std::string> names_;
  std::string text_;
  std::size_t position_ = 0;
  std::size_t line_ = 0;
  CsvRow row_;
};

/// Holds that time stamps rise from row to row; InputError names both stamps.
class RisingStamps {
 public:
  void add(const CsvRow& row, std::int64_t t_ns);

 private:
  bool empty_ = true;
  std::int64_t last_ns_ = 0;
  std::size_t last_line_ = 0;
};

}  // namespace leviosim::base
