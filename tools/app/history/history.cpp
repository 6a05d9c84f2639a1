#include "tools/app/history/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <tuple>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/sha256.h"
#include "tools/app/budget/baseline.h"

namespace leviosim::tools {
namespace {

constexpr std::string_view kKept = "{\"kept\":\"";
constexpr std::string_view kRun = "{\"run\":\"";
constexpr std::string_view kTime = "\",\"time\":";
constexpr std::size_t kDigits = 12;  ///< of a digest

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

std::string text_of(const Json& json) { return json.get<std::string>(); }

Origin origin_of(const Json& run) {
  Origin origin;
  origin.commit = text_of(run.at("run"));
  origin.branch = text_of(run.at("branch"));
  run.at("time").get_to(origin.time_s);
  origin.subject = text_of(run.at("subject"));
  return origin;
}

}  // namespace

std::string short_commit(const std::string& commit) {
  constexpr std::size_t kShort = 9;
  return commit.substr(0, kShort);
}

History::History(std::string file, std::string text)
    : file_(std::move(file)), text_(std::move(text)) {
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text_.size();) {
    ++number;
    const std::size_t end = std::min(text_.find('\n', begin), text_.size());
    const std::string_view line = std::string_view(text_).substr(begin, end - begin);
    Line at{begin, line.size(), 0};
    begin = end + 1;
    if (line.empty()) continue;
    if (line.starts_with(kKept)) {
      kept_.emplace(line.substr(kKept.size(), kDigits), at);
      continue;
    }
    const std::size_t time = line.find(kTime);
    const char* const from = line.data() + time + kTime.size();
    if (!line.starts_with(kRun) || time == std::string_view::npos || line.back() != '}' ||
        std::from_chars(from, line.data() + line.size(), at.time_s).ec != std::errc())
      throw InputError(fmt::format(
          "{}:{}: no line of a history; expected those that 'leviosim history add' writes", file_,
          number));
    runs_.push_back(at);
  }
  std::stable_sort(runs_.begin(), runs_.end(),
                   [](const Line& a, const Line& b) { return a.time_s < b.time_s; });
  // Of two histories that were merged, lines of both stand twice.
  std::vector<Line> once;
  for (const Line& line : runs_) {
    const auto of_then = std::lower_bound(
        once.begin(), once.end(), line, [](const Line& a, const Line& b) { return a.time_s < b.time_s; });
    if (std::none_of(of_then, once.end(), [&](const Line& other) { return bytes_of(other) == bytes_of(line); }))
      once.push_back(line);
  }
  runs_ = std::move(once);
}

History History::read(const std::string& file) {
  return History(file, base::read_file(file, base::InputKind::history));
}

std::string_view History::bytes_of(const Line& line) const {
  return std::string_view(text_).substr(line.begin, line.size);
}

Json History::parsed(const Line& line) const { return parse_json(file_, std::string(bytes_of(line))); }

const Json& History::kept(const std::string& digest) const {
  const auto known = parsed_.find(digest);
  if (known != parsed_.end()) return known->second;
  const auto line = kept_.find(digest);
  if (line == kept_.end())
    throw InputError(fmt::format("{}: lacks the line {}{}\"…, which runs need; expected all lines "
                                 "of the histories that it was merged from",
                                 file_, kKept, digest));
  return parsed_.emplace(digest, parsed(line->second).at("value")).first->second;
}

Origin History::origin(std::size_t i) const {
  return origin_of(parsed(runs_[i]));
}

PastRun History::run(std::size_t i) const {
  try {
    const Json run = parsed(runs_[i]);
    PastRun past;
    past.origin = origin_of(run);
    run.at("limits").get_to(past.limits.held);
    run.at("missed").get_to(past.limits.missed);
    past.record.name = short_commit(past.origin.commit);
    past.record.facts = facts_of_json(file_, kept(text_of(run.at("facts"))));
    past.record.facts.program = text_of(run.at("program"));
    const Json& names = kept(text_of(run.at("figures")));
    const Json& values = run.at("values");
    for (std::size_t k = 0; k < names.size(); ++k) {
      Statistic& statistic = past.record.statistics.emplace_back();
      statistic.name = text_of(names.at(k).at(0));
      statistic.unit = text_of(names.at(k).at(1));
      if (!values.at(k).is_null()) statistic.value = values.at(k).get<double>();
    }
    for (const Json& stage : run.at("stages"))
      add_baseline_stage(kept(text_of(stage)), past.record);
    return past;
  } catch (const nlohmann::json::exception&) {
    throw InputError(fmt::format("{}: a run of it is damaged; expected what 'leviosim history add' "
                                 "writes",
                                 file_));
  }
}

std::vector<PastRun> History::like(const RunRecord& run, const std::string& branch,
                                   std::size_t most) const {
  std::vector<PastRun> found;
  for (std::size_t i = size(); i > 0 && found.size() < most; --i) {
    PastRun past = this->run(i - 1);
    if (!branch.empty() && past.origin.branch != branch) continue;
    if (are_alike(past.record.facts, run.facts)) found.push_back(std::move(past));
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
  const std::string found = member("facts", facts.digest) + member("figures", names.digest) +
                            member("values", values);
  for (const Line& line : runs_) {
    if (!bytes_of(line).starts_with(begin) || bytes_of(line).find(facts.digest) == std::string_view::npos)
      continue;
    if (bytes_of(line).find(found) != std::string_view::npos) return {};
    throw InputError(fmt::format(
        "{}: has a run of {} with this chip, profile and data already, and other figures", file_,
        short_commit(run.origin.commit)));
  }
  return fmt::format("{}{}\"branch\":{}{}{}{}{}{}{}}}\n", lines, begin,
                     json_text(Json(run.origin.branch)), member("subject", run.origin.subject),
                     member("program", run.record.facts.program),
                     member("limits", run.limits.held), member("missed", run.limits.missed), found, member("stages", stages));
}

}  // namespace leviosim::tools
