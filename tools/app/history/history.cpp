#include "tools/app/history/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <functional>
#include <set>
#include <tuple>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/sha256.h"
#include "sim/outputs/growing_file.h"
#include "tools/app/budget/gate.h"
#include "tools/app/report/json_reader.h"

namespace leviosim::tools {
namespace {

constexpr std::string_view kKept = "{\"kept\":\"";
constexpr std::string_view kRun = "{\"run\":\"";
constexpr std::string_view kTime = "\",\"time\":";
constexpr std::size_t kDigits = 12;  ///< of a digest
/// A run of fifty stages takes a few kB.
constexpr JsonLimits kLineLimits{
    .bytes = std::size_t{1} << 20, .depth = 16, .values = 50'000, .members = 256};
constexpr std::size_t kMostStagesOfLine = 1000;

/// A shared line: what it holds, under its digest.
struct Shared {
  std::string digest;
  std::string line;
};

Shared shared(const char* what, const Json& value) {
  const std::string text = json_text(value);
  Shared result{base::sha256_of(what + text).substr(0, kDigits), {}};
  result.line =
      fmt::format("{}{}\",\"what\":\"{}\",\"value\":{}}}\n", kKept, result.digest, what, text);
  return result;
}

/// Nothing of a fact says which commit it is of.
Json facts_of(RunFacts facts) {
  facts.program.clear();
  return facts_json(facts);
}

Json names_of(const std::vector<BaselineFigure>& figures) {
  Json names = Json::array();
  for (const BaselineFigure& figure : figures) names.push_back({figure.name, figure.unit});
  return names;
}

bool are_alike(const RunFacts& a, const RunFacts& b) {
  const auto key = [](const RunFacts& f) {
    return std::tie(f.measured, f.profile, f.platform, f.cores, f.camera, f.seed, f.image_width,
                    f.image_height, f.first_frame, f.frames, f.inputs);
  };
  return key(a) == key(b);
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
  const auto begins = [&](std::string_view mark) {
    return last.starts_with(mark.substr(0, last.size()));
  };
  return (begins(kKept) || begins(kRun)) && !try_read_json(last, kLineLimits);
}

/// The digest that a line of a run has of what it shares; empty if it has none. No string holds
/// what is looked for: quotes in it have a backslash before them.
std::string_view digest_in(std::string_view line, std::string_view what) {
  const std::string begin = fmt::format(",\"{}\":\"", what);
  const std::size_t at = line.find(begin);
  return at == std::string_view::npos ? std::string_view()
                                      : line.substr(at + begin.size(), kDigits);
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
  if (text.starts_with(kKept)) {
    kept_.emplace(text.substr(kKept.size(), kDigits), line);
    return;
  }
  const std::size_t time = text.find(kTime);
  const std::string_view seconds =
      time == std::string_view::npos ? std::string_view() : text.substr(time + kTime.size());
  if (!text.starts_with(kRun) || text.back() != '}' ||
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

const Json& History::kept(const std::string& digest) const {
  const auto known = parsed_.find(digest);
  if (known != parsed_.end()) return known->second;
  const auto line = kept_.find(digest);
  if (line == kept_.end())
    throw InputError(
        fmt::format("{}: lacks the line {}{}\"…, which runs need; expected all lines "
                    "of the histories that it was merged from",
                    file_, kKept, digest));
  return parsed_.emplace(digest, parsed(line->second).at("value")).first->second;
}

Origin History::origin(std::size_t i) const { return origin_of(parsed(runs_[i])); }

PastRun History::run(std::size_t i) const {
  try {
    const Json run = parsed(runs_[i]);
    PastRun past;
    past.origin = origin_of(run);
    run.at("limits").get_to(past.limits.held);
    run.at("missed").get_to(past.limits.missed);
    past.record.name = short_commit(past.origin.commit);
    past.record.facts = facts_of_json(file_, kept(string_of(run.at("facts"))));
    past.record.facts.program = string_of(run.at("program"));
    const Json& names = kept(string_of(run.at("figures")));
    const Json& values = run.at("values");
    for (std::size_t k = 0; k < names.size(); ++k) {
      Statistic& statistic = past.record.statistics.emplace_back();
      statistic.name = string_of(names.at(k).at(0));
      statistic.unit = string_of(names.at(k).at(1));
      if (!values.at(k).is_null()) statistic.value = values.at(k).get<double>();
    }
    if (run.at("stages").size() > kMostStagesOfLine)
      throw InputError(fmt::format("{}: a run of it has {} stages; expected at most {}", file_,
                                   run.at("stages").size(), kMostStagesOfLine));
    for (const Json& stage : run.at("stages"))
      add_baseline_stage(kept(string_of(stage)), past.record);
    return past;
  } catch (const nlohmann::json::exception&) {
    throw InputError(
        fmt::format("{}: a run of it is damaged; expected what 'leviosim history add' "
                    "writes",
                    file_));
  }
}

std::vector<PastRun> History::like(const RunRecord& run, const std::string& branch,
                                   std::size_t most) const {
  std::vector<PastRun> found;
  std::unordered_map<std::string, bool> alike;  // by the digest of the facts
  for (std::size_t i = size(); i > 0 && found.size() < most; --i) {
    std::string digest(digest_in(text_of(runs_[i - 1]), "facts"));
    const auto known = alike.find(digest);
    if (known != alike.end() && !known->second) continue;  // without parsing the line
    PastRun past = this->run(i - 1);
    const bool is_alike = are_alike(past.record.facts, run.facts);
    alike.emplace(std::move(digest), is_alike);
    if (is_alike && (branch.empty() || past.origin.branch == branch))
      found.push_back(std::move(past));
  }
  std::reverse(found.begin(), found.end());
  return found;
}

std::string History::lines_for(const PastRun& run) const {
  const std::string begin =
      fmt::format("{}{}{}{},", kRun, run.origin.commit, kTime, run.origin.time_s);
  const Shared facts = shared("facts", facts_of(run.record.facts));
  const std::vector<BaselineFigure> figures = baseline_figures(run.record);
  const Shared names = shared("figures", names_of(figures));
  std::vector<Shared> all{facts, names};
  Json stages = Json::array();
  for (const Json& stage : baseline_stages(run.record)) {
    all.push_back(shared("stage", stage));
    stages.push_back(all.back().digest);
  }
  std::string lines;
  for (const Shared& line : all)
    if (kept_.find(line.digest) == kept_.end()) lines += line.line;
  Json values = Json::array();
  for (const BaselineFigure& figure : figures) values.push_back(figure.value);
  const auto member = [](const char* name, const Json& value) {
    return fmt::format(",\"{}\":{}", name, json_text(value));
  };
  const std::string found =
      member("facts", facts.digest) + member("figures", names.digest) + member("values", values);
  for (const Line& line : runs_) {
    if (line.time_s != run.origin.time_s) continue;
    const std::string_view text = text_of(line);
    if (!text.starts_with(begin) || digest_in(text, "facts") != facts.digest) continue;
    if (text.find(found) != std::string_view::npos) return {};
    throw InputError(fmt::format(
        "{}: has a run of {} with this chip, profile and data already, and other figures", file_,
        short_commit(run.origin.commit)));
  }
  return fmt::format("{}{}\"branch\":{}{}{}{}{}{}{}}}\n", lines, begin,
                     json_text(Json(run.origin.branch)), member("subject", run.origin.subject),
                     member("program", run.record.facts.program), member("limits", run.limits.held),
                     member("missed", run.limits.missed), found, member("stages", stages));
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
