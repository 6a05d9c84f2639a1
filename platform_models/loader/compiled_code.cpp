#include "platform_models/loader/compiled_code.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <set>
#include <utility>
#include <vector>

#include "platform_models/loader/builtin.h"
#include "sim/base/error.h"
#include "sim/base/text.h"

namespace leviosim::platform {
namespace {

constexpr double kLineBytes = 16;
constexpr std::string_view kHeader =
    "function,after,lines,visits,refetches,executed,priced,loads,used_at_once,"
    "executed_loops,priced_loops";
constexpr std::size_t kFirstCompiled = 5;
constexpr std::size_t kColumns = kFirstCompiled + work::kCompiledCount;

/// @param limit  exclusive
double number_in(std::string_view cell, double limit, std::string_view what,
                 const std::string& where) {
  const std::string text(cell);
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(number >= 0 && number < limit))
    throw InputError(
        fmt::format("{}: \"{}\": expected a number of {}, 0 or more", where, text, what));
  return number;
}

/// Lines of code as bytes.
std::uint32_t bytes_in(std::string_view cell, const std::string& where) {
  return static_cast<std::uint32_t>(
      std::lround(number_in(cell, 2e8, "16-byte lines", where) * kLineBytes));
}

/// The last columns of a row; none if they are empty.
work::CompiledSets compiled_in(const std::vector<std::string>& cells, const std::string& where) {
  work::CompiledSets compiled{};
  if (cells[kFirstCompiled].empty()) return compiled;
  for (std::size_t i = 0; i < work::kCompiledCount; ++i)
    compiled[i] = static_cast<std::uint64_t>(std::llround(
        number_in(cells[kFirstCompiled + i], 1e9, "instructions", where) * work::kCompiledUnit));
  return compiled;
}

class CodeSizeReader {
 public:
  /// What read() takes from now on is of this file.
  void begin(std::string file) {
    file_ = std::move(file);
    header_ = false;
    line_ = 0;
  }
  void read_all(std::string_view text) {
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      read(text.substr(begin, end - begin));
      begin = end + 1;
    }
  }

  void read(std::string_view line) {
    ++line_;
    if (line.empty() || line.front() == '#') return;
    const std::string where = fmt::format("{}:{}", file_, line_);
    if (header_)
      add(base::split(line, ','), where);
    else if (line != kHeader)
      throw InputError(fmt::format("{}: expected the header {}", where, kHeader));
    header_ = true;
  }
  work::CodeMap take() { return std::move(map_); }

 private:
  void add(const std::vector<std::string>& cells, const std::string& where) {
    if (cells.size() != kColumns || cells[0].empty())
      throw InputError(fmt::format("{}: expected a row of {}", where, kHeader));
    if (!seen_.insert({cells[0], cells[1]}).second)
      throw InputError(
          fmt::format("{}: {} after \"{}\" is there twice", where, cells[0], cells[1]));
    map_.add(cells[0], cells[1], bytes_in(cells[2], where), bytes_in(cells[4], where),
             compiled_in(cells, where));
  }

  std::string file_;
  work::CodeMap map_;
  std::set<std::pair<std::string, std::string>> seen_;
  bool header_ = false;
  int line_ = 0;
};

}  // namespace

work::CodeMap code_map_from(const std::string& file, std::string_view text) {
  CodeSizeReader reader;
  reader.begin(file);
  reader.read_all(text);
  return reader.take();
}

namespace {

/// Of the table with this name. @throws InputError
std::string_view builtin_table(std::string_view name) {
  std::vector<std::string> names;
  for (const base::BuiltinFile& file : builtin_code()) {
    if (file.name == name) return file.text;
    names.emplace_back(file.name);
  }
  throw InputError(
      fmt::format("no table of compiled code '{}' (platform_models/code/{}.csv); there is {}", name,
                  name, fmt::join(names, ", ")));
}

/// Written by add_compiled_code() only.
std::vector<CodeTable>& added_tables() {
  static std::vector<CodeTable> all;
  return all;
}

/// With what was added.
work::CodeMap whole_table(std::string_view name) {
  CodeSizeReader reader;
  reader.begin(fmt::format("{}.csv", name));
  reader.read_all(builtin_table(name));
  for (const CodeTable& table : added_tables()) {
    if (table.set != name) continue;
    reader.begin(fmt::format("{}.csv of a workload", name));
    reader.read_all(table.text);
  }
  return reader.take();
}

}  // namespace

work::CodeMap code_map_named(std::string_view name) {
  return code_map_from(fmt::format("{}.csv", name), builtin_table(name));
}

void add_compiled_code(const CodeTable& table) {
  added_tables().push_back(table);
  try {
    whole_table(table.set);
  } catch (...) {
    added_tables().pop_back();
    throw;
  }
}

namespace {

/// The tables of all instruction sets, by work::CompiledFor.
const std::vector<work::CodeMap>& tables() {
  static const std::vector<work::CodeMap> all = [] {
    std::vector<work::CodeMap> read;
    for (const std::string_view name : work::kCompiledFor) read.push_back(whole_table(name));
    return read;
  }();
  return all;
}

const work::CodeMap& table_of(work::CompiledFor set) {
  return tables()[static_cast<std::size_t>(set)];
}

/// In the table of `set`, or else in that of kCompiledCode.
work::CompiledWork executed_by(const work::CodeMap::Piece& piece, work::CompiledFor set) {
  const work::CompiledWork own = work::compiled_of(piece.compiled, work::CompiledFor::Rv32imfc);
  const work::CodeMap& table = table_of(set);
  const int there = table.find(piece.key);
  if (there == work::CodeMap::kUnknown) return own;
  const work::CompiledWork measured = work::compiled_of(
      table.pieces()[static_cast<std::size_t>(there)].compiled, work::CompiledFor::Rv32imfc);
  return measured == work::CompiledWork{} ? own : measured;
}

}  // namespace

const work::CodeMap& compiled_code() {
  static const work::CodeMap all = [] {
    work::CodeMap map = whole_table(kCompiledCode);
    for (std::size_t i = 0; i < map.pieces().size(); ++i)
      for (std::size_t k = 1; k < work::kCompiledFor.size(); ++k) {
        const auto set = static_cast<work::CompiledFor>(k);
        map.set_compiled(static_cast<int>(i), set, executed_by(map.pieces()[i], set));
      }
    return map;
  }();
  return all;
}

double size_of_code(work::CompiledFor set) {
  struct Measured {
    double bytes, bytes_rv32;
  };
  // By work::CompiledFor, of all functions that there were when measure.sh compiled them last: some
  // have gone since, and their rows with them.
  constexpr std::array<Measured, work::kCompiledFor.size()> kMeasured = {
      {{114187, 114187}, {108585, 114187}, {132449, 111157}, {114130, 114187}}};
  const Measured& code = kMeasured[static_cast<std::size_t>(set)];
  return code.bytes / code.bytes_rv32;
}

}  // namespace leviosim::platform
