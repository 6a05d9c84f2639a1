#include "sim/outputs/output_record.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <set>

#include "sim/base/error.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestRecord = 64 << 20;
constexpr std::string_view kHeader = "leviosim files 1";
constexpr std::string_view kJournal = "leviosim journal 1 ";

std::string escaped(const std::string& path) {
  std::string text;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte > 0x7e || c == '%')
      text += fmt::format("%{:02X}", byte);
    else
      text += c;
  }
  return text;
}

std::optional<std::string> unescaped(std::string_view text) {
  std::string path;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      path += text[i];
      continue;
    }
    unsigned byte = 0;
    if (i + 2 >= text.size()) return std::nullopt;
    const char* const end = text.data() + i + 3;
    if (std::from_chars(text.data() + i + 1, end, byte, 16).ptr != end) return std::nullopt;
    path += static_cast<char>(byte);
    i += 2;
  }
  return path;
}

/// Relative, and below the folder by every reading.
bool is_inside(const std::string& path) {
  if (path.empty() || path.find('\0') != std::string::npos) return false;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string part = path.substr(begin, end - begin);
    if (part.empty() || part == "." || part == "..") return false;
    begin = end + 1;
  }
  return path != kRecordName;
}

/// "<SHA-256> <size>" or "- -".
std::optional<FileState> parse_state(std::string_view sha256, std::string_view size) {
  if (sha256 == "-" && size == "-") return FileState{};
  FileState state{std::string(sha256), 0};
  const bool is_hex =
      sha256.size() == 64 && sha256.find_first_not_of("0123456789abcdef") == std::string_view::npos;
  const char* const end = size.data() + size.size();
  const auto [stop, error] = std::from_chars(size.data(), end, state.size);
  if (!is_hex || size.empty() || error != std::errc() || stop != end) return std::nullopt;
  return state;
}

bool parse_line(std::string_view line, OutputRecord& record) {
  const std::size_t first = line.find(' ');
  if (first == std::string_view::npos) return false;
  const std::size_t second = line.find(' ', first + 1);
  if (second == std::string_view::npos) return false;
  const auto state = parse_state(line.substr(0, first), line.substr(first + 1, second - first - 1));
  const auto path = unescaped(line.substr(second + 1));
  if (!state || !path || !is_inside(*path)) return false;
  record.add(*path, *state);
  return true;
}

/// The process that a journal's first line names.
std::optional<int> parse_journal_header(std::string_view line) {
  if (!line.starts_with(kJournal)) return std::nullopt;
  int process = 0;
  const char* const end = line.data() + line.size();
  const auto [stop, error] = std::from_chars(line.data() + kJournal.size(), end, process);
  if (error != std::errc() || stop != end || process <= 0) return std::nullopt;
  return process;
}

/// "mav0" and "mav0/cam0" of "mav0/cam0/data.csv".
std::set<std::string> folders_of(const std::vector<std::string>& paths) {
  std::set<std::string> folders;
  for (const std::string& path : paths)
    for (std::size_t end = path.find('/'); end != std::string::npos; end = path.find('/', end + 1))
      folders.insert(path.substr(0, end));
  return folders;
}

}  // namespace

OutputRecord OutputRecord::parse(std::string_view text, const std::string& name) {
  OutputRecord record;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) break;  // cut off
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    if (number > 1) {
      if (!parse_line(line, record))
        throw InputError(fmt::format("{}:{}: expected '<SHA-256> <size> <path>'", name, number));
      continue;
    }
    const std::optional<int> process = parse_journal_header(line);
    if (line != kHeader && !process)
      throw InputError(
          fmt::format("{}:1: expected '{}': this is no record of files that leviosim "
                      "wrote, or one of another version",
                      name, kHeader));
    record.process_ = process.value_or(0);
  }
  return record;
}

std::optional<OutputRecord> OutputRecord::read(const fs::path& folder) {
  const fs::path file = folder / kRecordName;
  if (!status_of(file)) return std::nullopt;
  if (::access(file.c_str(), R_OK) != 0 && errno == EACCES) return std::nullopt;  // another user's
  const std::optional<std::string> text = try_read_file(file, kLargestRecord);
  if (!text) throw InputError(fmt::format("{}: cannot be read as a record", file.string()));
  return parse(*text, file.string());
}

std::string OutputRecord::text() const {
  std::string text = header();
  for (const auto& [path, state] : files_) text += line(path, state);
  return text;
}

std::string OutputRecord::journal_header() { return fmt::format("{}{}\n", kJournal, ::getpid()); }

std::string OutputRecord::line(const std::string& path, const FileState& state) {
  if (state.sha256.empty()) return fmt::format("- - {}\n", escaped(path));
  return fmt::format("{} {} {}\n", state.sha256, state.size, escaped(path));
}

bool OutputRecord::says(const std::string& path, const FileState& state) const {
  const auto [begin, end] = files_.equal_range(path);
  return std::any_of(begin, end, [&](const auto& file) { return file.second == state; });
}

bool OutputRecord::describes(const fs::path& folder, const std::string& path) const {
  const std::optional<struct stat> status = status_of(folder / path);
  if (!status || !S_ISREG(status->st_mode)) return false;
  const auto [begin, end] = files_.equal_range(path);
  const bool digested =
      std::any_of(begin, end, [](const auto& file) { return !file.second.sha256.empty(); });
  if (!digested) return begin != end && process_ != 0;
  const auto size = static_cast<std::uint64_t>(status->st_size);
  if (std::none_of(begin, end, [&](const auto& file) { return file.second.size == size; }))
    return false;
  const std::optional<FileState> state = state_of_file(folder / path);
  return state && says(path, *state);
}

bool OutputRecord::leads_through(const std::string& folder) const {
  const auto next = files_.lower_bound(folder + '/');
  return next != files_.end() && next->first.starts_with(folder + '/');
}

std::string OutputRecord::first_foreign(const fs::path& folder, bool any_bytes) const {
  std::vector<fs::path> open{fs::path()};
  while (!open.empty()) {
    const fs::path at = open.back();
    open.pop_back();
    std::set<std::string> entries;
    std::error_code error;
    for (fs::directory_iterator entry(folder / at, error), end; !error && entry != end;
         entry.increment(error))
      entries.insert((at / entry->path().filename()).string());
    if (error) return at.empty() ? "what cannot be listed" : at.string();
    for (const std::string& name : entries) {
      if (name == kRecordName) continue;
      const std::optional<struct stat> status = status_of(folder / name);
      if (!status) continue;  // gone meanwhile
      if (S_ISDIR(status->st_mode) && leads_through(name))
        open.emplace_back(name);
      else if (!(any_bytes && S_ISREG(status->st_mode) && names(name)) && !describes(folder, name))
        return name;
    }
  }
  return {};
}

bool OutputRecord::is_complete(const fs::path& folder) const {
  const std::vector<std::string> all = paths();
  return std::all_of(all.begin(), all.end(),
                     [&](const std::string& path) { return describes(folder, path); });
}

void OutputRecord::remove_files_from(const fs::path& folder) const {
  const std::vector<std::string> all = paths();
  for (const std::string& path : all) ::unlink((folder / path).c_str());
  const std::set<std::string> folders = folders_of(all);
  for (auto name = folders.rbegin(); name != folders.rend(); ++name)
    ::rmdir((folder / *name).c_str());
}

void OutputRecord::drop_states_without_digest() {
  std::erase_if(files_, [](const auto& file) { return file.second.sha256.empty(); });
}

void OutputRecord::remove_from(const fs::path& folder) const {
  remove_files_from(folder);
  ::unlink((folder / kRecordName).c_str());
  ::rmdir(folder.c_str());
}

std::vector<std::string> OutputRecord::paths() const {
  std::vector<std::string> all;
  for (auto file = files_.begin(); file != files_.end(); file = files_.upper_bound(file->first))
    all.push_back(file->first);
  return all;
}

}  // namespace leviosim::outputs
