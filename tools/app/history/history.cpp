#include "tools/app/history/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <functional>
#include <set>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/sha256.h"
#include "sim/outputs/growing_file.h"
#include "tools/app/record/json_reader.h"

namespace leviosim::tools {
namespace {

constexpr std::string_view kRun = "{\"run\":\"";
constexpr std::string_view kTime = "\",\"time\":";
constexpr std::string_view kLike = ",\"like\":\"";
constexpr std::string_view kFacts = ",\"facts\":";
constexpr std::string_view kStatistics = ",\"statistics\":";
constexpr std::string_view kStages = ",\"stages\":";
constexpr std::string_view kOldLine = "{\"kept\":\"";
constexpr std::size_t kDigits = 12;  ///< of a digest
/// A run of fifty stages takes some 20 kB.
constexpr JsonLimits kLineLimits{.bytes = std::size_t{1} << 20, .depth = 16, .values = 50'000};

/// Of what runs that can be compared have in common.
std::string like_digest(RunFacts facts) {
  facts.program.clear();
  facts.workload.clear();
  facts.overrides.clear();
  return base::sha256_of(json_text(facts_json(facts))).substr(0, kDigits);
}

std::string string_of(const Json& json) { return json.get<std::string>(); }

Origin origin_of(const Json& run) {
  Origin origin;
  origin.commit = string_of(run.at("run"));
  origin.branch = string_of(run.at("branch"));
  run.at("time").get_to(origin.time_s);
  origin.subject = string_of(run.at("subject"));
  return origin;
}

/// Whether it is what an interrupted program leaves at the end of a file.
bool is_unfinished(std::string_view last) {
  return last.starts_with(kRun.substr(0, last.size())) && !try_read_json(last, kLineLimits);
}

/// What stands between two parts of a line; empty if they are not there. No string holds what is
/// looked for: quotes in it have a backslash before them.
std::string_view between(std::string_view line, std::string_view begin, std::string_view end) {
  const std::size_t at = line.find(begin);
  if (at == std::string_view::npos) return {};
  const std::string_view rest = line.substr(at + begin.size());
  return rest.substr(0, std::min(rest.find(end), rest.size()));
}

}  // namespace

std::string short_commit(const std::string& commit) {
  constexpr std::size_t kShort = 9;
  return commit.substr(0, kShort);
}

History::History(std::string file, base::Pieces text)
    : file_(std::move(file)), pieces_(std::move(text)) {
  std::size_t number = 0;
  while (whole_size_ < pieces_.size()) {
    const std::string_view line = pieces_.line_at(whole_size_, kLineLimits.bytes);
    const std::uint64_t end = whole_size_ + line.size();
    if (end == pieces_.size() && is_unfinished(line)) break;
    if (!line.empty()) add_line(line, {whole_size_, line.size()}, ++number);
    whole_size_ = std::min(end + 1, pieces_.size());
  }
  std::stable_sort(runs_.begin(), runs_.end(),
                   [](const Line& a, const Line& b) { return a.time_s < b.time_s; });
  // Of two histories that were merged, lines of both stand twice.
  std::set<std::pair<std::size_t, std::size_t>> of_then;  // sizes and hashes
  std::int64_t then = 0;
  std::erase_if(runs_, [&](const Line& line) {
    if (line.time_s != then) of_then.clear();
    then = line.time_s;
    return !of_then.emplace(line.size, line.hash).second;
  });
}

void History::add_line(std::string_view text, Line line, std::size_t number) {
  if (text.starts_with(kOldLine))
    throw InputError(
        fmt::format("{}: is a history of an earlier leviosim; add the runs to a new one: leviosim "
                    "history add RUN --file FILE",
                    file_));
  const std::size_t time = text.find(kTime);
  const std::string_view seconds =
      time == std::string_view::npos ? std::string_view() : text.substr(time + kTime.size());
  if (!text.starts_with(kRun) || text.back() != '}' || between(text, kLike, "\"").empty() ||
      std::from_chars(seconds.data(), seconds.data() + seconds.size(), line.time_s).ec !=
          std::errc())
    throw InputError(fmt::format(
        "{}:{}: no line of a history; expected those that 'leviosim history add' writes", file_,
        number));
  line.hash = std::hash<std::string_view>()(text);
  runs_.push_back(line);
}

History History::read(const std::string& file) {
  return {file, base::Pieces(base::OpenedFile(file, base::InputKind::history))};
}

bool History::ends_a_line() const {
  return whole_size_ == 0 || pieces_.at(whole_size_ - 1, 1) == "\n";
}

Json History::parsed(const Line& line) const {
  ++lines_parsed_;
  return read_json(file_, text_of(line), kLineLimits);
}

Origin History::origin(std::size_t i) const { return origin_of(parsed(runs_[i])); }

PastRun History::run(std::size_t i) const {
  const Json line = parsed(runs_[i]);
  PastRun past;
  try {
    past.origin = origin_of(line);
    line.at("limits").at("held").get_to(past.limits.held);
    line.at("limits").at("missed").get_to(past.limits.missed);
    past.record = record_of_json(file_, line.at("record"), Level::kept);
  } catch (const Json::exception&) {
    throw InputError(fmt::format(
        "{}: a run of it is damaged; expected what 'leviosim history add' writes", file_));
  }
  past.record.name = short_commit(past.origin.commit);
  return past;
}

std::vector<PastRun> History::like(const RunRecord& run, const std::string& branch,
                                   std::size_t most) const {
  std::vector<PastRun> found;
  const std::string digest = like_digest(run.facts);
  for (std::size_t i = size(); i > 0 && found.size() < most; --i) {
    if (between(text_of(runs_[i - 1]), kLike, "\"") != digest) continue;
    PastRun past = this->run(i - 1);
    if (branch.empty() || past.origin.branch == branch) found.push_back(std::move(past));
  }
  std::reverse(found.begin(), found.end());
  return found;
}

std::string History::line_for(const PastRun& run) const {
  const Json line{{"run", run.origin.commit},
                  {"time", run.origin.time_s},
                  {"like", like_digest(run.record.facts)},
                  {"branch", run.origin.branch},
                  {"subject", run.origin.subject},
                  {"limits", {{"held", run.limits.held}, {"missed", run.limits.missed}}},
                  {"record", record_json(reduced(run.record, Level::kept))}};
  const std::string text = json_text(line);
  const std::string_view begin = between(text, kRun, ",\"branch\":");
  for (const Line& known : runs_) {
    if (known.time_s != run.origin.time_s) continue;
    const std::string_view there = text_of(known);
    if (!there.substr(kRun.size()).starts_with(begin) ||
        between(there, kFacts, kStatistics) != between(text, kFacts, kStatistics))
      continue;
    if (between(there, kStatistics, kStages) == between(text, kStatistics, kStages)) return {};
    throw InputError(fmt::format(
        "{}: has a run of {} with this chip, profile and data already, and other figures", file_,
        short_commit(run.origin.commit)));
  }
  return text + '\n';
}

void add_to_history(const std::string& file,
                    const std::function<std::string(const History&)>& lines) {
  constexpr std::chrono::seconds kPatience{30};
  const auto addition = [&](std::optional<base::OpenedFile> there) {
    const std::uint64_t size = there ? there->size() : 0;
    const History history(file,
                          there ? base::Pieces(std::move(*there)) : base::Pieces(std::string()));
    // A history begins with whole lines: add_lines() makes no others.
    if (history.whole_size() == 0 && size > 0)
      throw InputError(
          fmt::format("{}: holds one line that lacks its end, and no run, so it may be no history; "
                      "remove it by hand if it is of no use",
                      file));
    outputs::Addition wanted{history.whole_size(), lines(history)};
    if (!wanted.lines.empty() && !history.ends_a_line()) wanted.lines.insert(0, 1, '\n');
    return wanted;
  };
  outputs::add_lines(file, base::InputKind::history, kPatience, addition);
}

}  // namespace leviosim::tools
