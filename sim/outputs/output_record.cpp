#include "sim/outputs/output_record.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <set>

#include "sim/base/error.h"
#include "sim/outputs/growing_file.h"
#include "sim/outputs/try_again.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;

/// Flights of an hour have 70 000 files.
constexpr int kMostLines = 200'000;
constexpr std::uint64_t kLargestRecord = 16 << 20;
constexpr std::string_view kHeader = "leviosim files 1";

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

/// @param name  of an entry of a folder
bool is_unfinished(const std::string& name, const struct stat& status) {
  if (!S_ISREG(status.st_mode) || status.st_nlink != 1) return false;
  return name == unfinished_name(status) || (name == kUnnumbered && status.st_size == 0);
}

}  // namespace

OutputRecord OutputRecord::parse(std::string_view text, const std::string& name) {
  OutputRecord record;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) break;  // cut off
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    if (number > kMostLines)
      throw InputError(fmt::format("{}: has more than {} lines", name, kMostLines));
    if (number > 1) {
      if (!parse_line(line, record))
        throw InputError(fmt::format("{}:{}: expected '<SHA-256> <size> <path>'", name, number));
      continue;
    }
    if (line != kHeader)
      throw InputError(
          fmt::format("{}:1: expected '{}': this is no record of files that leviosim "
                      "wrote, or one of another version",
                      name, kHeader));
  }
  return record;
}

namespace {

OutputRecord parsed(const std::optional<std::string>& text, const fs::path& file) {
  if (!text) throw InputError(fmt::format("{}: cannot be read as a record", file.string()));
  return OutputRecord::parse(*text, file.string());
}

}  // namespace

std::optional<OutputRecord> OutputRecord::read(const fs::path& folder) {
  const fs::path file = folder / kRecordName;
  if (!status_of(file)) return std::nullopt;
  if (::access(file.c_str(), R_OK) != 0 && errno == EACCES) return std::nullopt;  // another user's
  return parsed(try_read_file(file, kLargestRecord), file);
}

std::string OutputRecord::text() const {
  std::string text = header();
  for (const auto& [path, state] : files_) text += line(path, state);
  return text;
}

std::string OutputRecord::line(const std::string& path, const FileState& state) {
  if (state.sha256.empty()) return fmt::format("- - {}\n", escaped(path));
  return fmt::format("{} {} {}\n", state.sha256, state.size, escaped(path));
}

bool OutputRecord::says(const std::string& path, const FileState& state) const {
  const auto [begin, end] = files_.equal_range(path);
  return std::any_of(begin, end, [&](const auto& file) { return file.second == state; });
}

bool OutputRecord::describes(const fs::path& folder, const std::string& path,
                             bool any_bytes) const {
  const std::optional<struct stat> status = status_of(folder / path);
  if (!status || !S_ISREG(status->st_mode)) return false;
  const auto [begin, end] = files_.equal_range(path);
  if (any_bytes) return begin != end;
  const auto size = static_cast<std::uint64_t>(status->st_size);
  if (std::none_of(begin, end, [&](const auto& file) {
        return file.second.size == size && !file.second.sha256.empty();
      }))
    return false;
  const std::optional<FileState> state = state_of_file(folder / path);
  return state && says(path, *state);
}

bool OutputRecord::leads_through(const std::string& folder) const {
  const auto next = files_.lower_bound(folder + '/');
  return next != files_.end() && next->first.starts_with(folder + '/');
}

bool OutputRecord::is_complete(const fs::path& folder) const {
  const std::vector<std::string> all = paths();
  return std::all_of(all.begin(), all.end(),
                     [&](const std::string& path) { return describes(folder, path); });
}

std::vector<std::string> OutputRecord::paths() const {
  std::vector<std::string> all;
  for (auto file = files_.begin(); file != files_.end(); file = files_.upper_bound(file->first))
    all.push_back(file->first);
  return all;
}

void OutputRecord::remove_files(const Descriptor& folder) const {
  for (const auto& [path, state] : files_) ::unlinkat(folder.get(), path.c_str(), 0);
}

std::string unfinished_name(const struct stat& file) {
  return fmt::format(".leviosim-{}", file.st_ino);
}

FolderContents contents_of(const fs::path& folder, bool any_bytes) {
  FolderContents found{
      .record = OutputRecord::read(folder), .files = {}, .folders = {}, .foreign = {}};
  const OutputRecord record = found.record.value_or(OutputRecord());
  std::vector<fs::path> open{fs::path()};
  while (!open.empty()) {
    const fs::path at = open.back();
    open.pop_back();
    const std::optional<std::set<std::string>> entries = names_in(folder / at);
    if (!entries) {
      found.foreign = at.empty() ? "what cannot be listed" : at.string();
      return found;
    }
    for (const std::string& entry : *entries) {
      const std::string name = (at / entry).string();
      const std::optional<struct stat> status = status_of(folder / name);
      if (!status || name == kRecordName) continue;  // gone meanwhile
      if (S_ISDIR(status->st_mode) && record.leads_through(name)) {
        open.emplace_back(name);
        found.folders.push_back(name);
      } else if (is_unfinished(name, *status) || record.describes(folder, name, any_bytes)) {
        found.files.push_back(name);
      } else {
        found.foreign = name;
        return found;
      }
    }
  }
  return found;
}

void FolderContents::remove(const Descriptor& folder) const {
  for (const std::string& file : files) ::unlinkat(folder.get(), file.c_str(), 0);
  for (auto name = folders.rbegin(); name != folders.rend(); ++name)
    ::unlinkat(folder.get(), name->c_str(), AT_REMOVEDIR);
}

HeldRecord::HeldRecord(const fs::path& folder, std::chrono::milliseconds patience)
    : path_(folder / kRecordName) {
  int error = 0;
  file_ = open_locked(path_, O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW, patience, error);
  if (error == EWOULDBLOCK) {
    state_ = State::busy;
  } else if (error == EACCES || error == EPERM || error == EROFS || error == ENOENT) {
    record_ = OutputRecord::read(folder).value_or(OutputRecord());
  } else if (error != 0) {
    fail(error);
  } else {
    state_ = State::held;
    struct stat held {};
    if (::fstat(file_.get(), &held) != 0) fail(errno);
    if (!S_ISREG(held.st_mode) || held.st_nlink != 1)
      throw InputError(fmt::format(
          "{}: is no regular file with one name, and so is not written to; remove it by hand",
          path_.string()));
    // What was only just made is not read, so that nothing can fail which would leave it.
    if (held.st_size > 0) record_ = parsed(try_read_file(file_, kLargestRecord), path_);
  }
}

bool HeldRecord::is_empty() const {
  struct stat status {};
  return ::fstat(file_.get(), &status) == 0 && status.st_size == 0;
}

void HeldRecord::add(const std::string& path, const FileState& state) {
  if (state_ != State::held || record_.says(path, state)) return;
  struct stat before {};
  if (::fstat(file_.get(), &before) != 0) fail(errno);
  const std::string line = OutputRecord::line(path, state);
  record_.add(path, state);
  const int error =
      write_all(file_.get(), before.st_size == 0 ? OutputRecord::header() + line : line);
  if (error == 0) return;
  if (::ftruncate(file_.get(), before.st_size) != 0) fail(errno);
  fail(error);
}

void HeldRecord::clear() {
  if (::ftruncate(file_.get(), 0) != 0) fail(errno);
  record_ = {};
}

void HeldRecord::fail(int error) const {
  fail_writing(error, fmt::format("{}: cannot be written: {}", path_.string(), reason(error)));
}

HeldRecord shared_record(const fs::path& folder) {
  HeldRecord record(folder, kPatience);
  if (record.state() == HeldRecord::State::busy)
    throw TryAgain(fmt::format("{}: another process holds it; try again when that has ended",
                               (folder / kRecordName).string()));
  return record;
}

void add_to_record(const fs::path& folder, const std::string& name, const FileState& state) {
  shared_record(folder).add(name, state);
}

}  // namespace leviosim::outputs
