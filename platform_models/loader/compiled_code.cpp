#include "platform_models/loader/compiled_code.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
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
      std::lround(number_in(cell, 1e6, "16-byte lines", where) * kLineBytes));
}

/// The last columns of a row; none if they are empty.
work::CompiledWork compiled_in(const std::vector<std::string>& cells, const std::string& where) {
  work::CompiledWork compiled{};
  if (cells[kFirstCompiled].empty()) return compiled;
  for (std::size_t i = 0; i < work::kCompiledCount; ++i)
    compiled[i] = static_cast<std::uint64_t>(std::llround(
        number_in(cells[kFirstCompiled + i], 1e9, "instructions", where) * work::kCompiledUnit));
  return compiled;
}

class CodeSizeReader {
 public:
  explicit CodeSizeReader(std::string file) : file_(std::move(file)) {}

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
  CodeSizeReader reader(file);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    reader.read(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return reader.take();
}

work::CodeMap code_map_named(std::string_view name) {
  std::vector<std::string> names;
  for (const base::BuiltinFile& file : builtin_code()) {
    if (file.name == name) return code_map_from(fmt::format("{}.csv", name), file.text);
    names.emplace_back(file.name);
  }
  throw InputError(
      fmt::format("no table of compiled code '{}' (platform_models/code/{}.csv); there is {}", name,
                  name, fmt::join(names, ", ")));
}

const work::CodeMap& compiled_code() {
  static const work::CodeMap map = code_map_named(kCompiledCode);
  return map;
}

}  // namespace leviosim::platform
