#include "tools/app/budget/budget.h"
#include "tools/app/budget/check.h"
#include "tools/app/budget/figures.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>

#include "platform_models/loader/schema.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/text.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/result/summary.h"
#include "tools/app/result/verdict.h"
#include "tools/app/run/yaml_map.h"

namespace leviosim::tools {
namespace {

using platform::Place;
using platform::YamlNode;

class BudgetReader {
 public:
  explicit BudgetReader(const std::string& file) { budget_.file = file; }

  Budget read(const std::string& text) {
    const YamlMap root(platform::parse_yaml(budget_.file, text), budget_.file, "");
    root.check_keys({"budgets", "accepted"});
    for (const YamlNode& node : root.items("accepted")) read_accepted(node);
    for (const YamlNode& node : root.items("budgets")) read_section(node);
    if (budget_.sections.empty())
      throw InputError(
          fmt::format("{}: has no budgets; expected a list of them under 'budgets'", budget_.file));
    return std::move(budget_);
  }

 private:
  void read_section(const YamlNode& node) {
    BudgetSection section;
    std::string reason;
    std::string owner;
    const YamlMap map(node, budget_.file, "budgets");
    map.check_keys({"name", "platform", "profile", "reason", "owner", "limits"});
    map.read("name", section.name);
    map.read("platform", section.platform);
    map.read("profile", section.profile);
    map.read("reason", reason);
    map.read("owner", owner);
    for (const YamlNode& limit : map.items("limits")) section.limits.push_back(read_limit(limit));
    if (section.limits.empty())
      platform::place_of(budget_.file, node.line(), "budgets")
          .fail("has no limits; expected 'limits' with at least one");
    if (section.name.empty()) section.name = section.profile + " on " + section.platform;
    for (Limit& limit : section.limits) {
      if (limit.reason.empty()) limit.reason = reason;
      if (limit.owner.empty()) limit.owner = owner;
    }
    budget_.sections.push_back(std::move(section));
  }

  void read_accepted(const YamlNode& node) {
    AcceptedMiss& miss = budget_.accepted.emplace_back();
    const YamlMap map(node, budget_.file, "accepted");
    map.check_keys({"limit", "reason", "until"});
    map.read("limit", miss.limit);
    map.read("reason", miss.reason);
    if (const YamlMap::Entry* until = map.find("until"))
      miss.until =
          parse_day(fmt::format("{}:{}: until", budget_.file, until->line), map.text(*until));
    miss.line = node.line();
    if (miss.limit.empty() || miss.reason.empty() || miss.until.empty())
      platform::place_of(budget_.file, node.line(), "accepted")
          .fail("expected limit, reason and until");
  }

  /// A text, or a map with it.
  Limit read_limit(const YamlNode& node) const {
    const Place here = platform::place_of(budget_.file, node.line(), "limits");
    Limit limit;
    if (node.is_scalar()) {
      limit = parse_limit(node.scalar(), here);
    } else {
      const YamlMap map(node, budget_.file, "limits");
      map.check_keys({"limit", "stage", "level", "reason", "owner"});
      const YamlMap::Entry* text = map.find("limit");
      if (text == nullptr) here.fail("has no 'limit'");
      limit = parse_limit(map.text(*text), map.place(*text));
      map.read("stage", limit.stage);
      map.read("reason", limit.reason);
      map.read("owner", limit.owner);
      std::string level = "fail";
      map.read("level", level);
      if (level != "fail" && level != "warn")
        here.fail(fmt::format("level '{}': expected fail or warn", level));
      limit.warns = level == "warn";
    }
    limit.file = budget_.file;
    limit.line = node.line();
    check_figure(limit);
    return limit;
  }

  Budget budget_;
};

/// Whether a finding of the limit may have that title (Finding::title()).
bool is_title_of(const Limit& limit, const std::string& title) {
  const bool has_stage = !limit.stage.empty();
  const std::string end = has_stage ? ": " + limit.text : limit.text.substr(limit.figure.size());
  if (!title.ends_with(end)) return false;
  const std::string about = title.substr(0, title.size() - end.size());
  return has_stage ? matches(limit.stage, about) || matches(limit.stage, key_of(about))
                   : matches(limit.figure, about);
}

void check_accepted(const Budget& budget) {
  std::vector<std::string> titles;
  const auto add = [&](const BudgetSection& section) {
    for (const Limit& limit : section.limits)
      titles.push_back(limit.stage.empty() ? limit.text : limit.stage + ": " + limit.text);
  };
  const auto is_known = [](const BudgetSection& section, const std::string& title) {
    return std::any_of(section.limits.begin(), section.limits.end(),
                       [&](const Limit& limit) { return is_title_of(limit, title); });
  };
  for (const BudgetSection& section : budget.sections) add(section);
  add(budget.verdicts);
  for (const AcceptedMiss& miss : budget.accepted)
    if (!is_known(budget.verdicts, miss.limit) &&
        std::none_of(budget.sections.begin(), budget.sections.end(),
                     [&](const BudgetSection& s) { return is_known(s, miss.limit); }))
      platform::place_of(budget.file, miss.line, "accepted")
          .fail(fmt::format("'{}' is no limit of this budget{}", miss.limit,
                            base::did_you_mean(miss.limit, titles)));
}

constexpr std::string_view kAccepted = "accepted:\n";

/// What leaves most of the room of a limit unused: the largest value for "<=", else the least.
std::optional<double> needed(const Limit& limit, const RunRecord& run) {
  std::optional<double> most;
  for (const FigureOf& figure : figures_of(limit, run)) {
    const auto value = figure.statistic->value;
    if (value && (!most || (limit.bound.at_most ? *value > *most : *value < *most))) most = value;
  }
  return most;
}

/// Four digits, never to the wrong side of the value.
std::string rounded_to_side(double value, bool up) {
  if (value == 0) return "0";
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - 3);
  const double steps = value / unit;
  const double whole = up ? std::ceil(steps - 1e-9) : std::floor(steps + 1e-9);
  return fmt::format("{:.10g}", whole * unit);
}

/// The limit's text with another number.
std::string with_number(const Limit& limit, const std::string& number) {
  const std::string unit = limit.bound.unit.empty() ? "" : " " + limit.bound.unit;
  return fmt::format("{} {} {}{}", limit.figure, limit.bound.at_most ? "<=" : ">=", number, unit);
}

struct FirstLimit {
  const char* figure;
  const char* statistic;
  double scale;  ///< from the statistic's unit
  const char* unit;
  int decimals;
};
constexpr std::array kFirstLimits{
    FirstLimit{"frame time p99", "frame.time.p99", 1e-6, "ms", 2},
    FirstLimit{"missed", "frame.missed_share", 100, "%", 2},
    FirstLimit{"frame cycles", "frame.cycles.parallel.mean", 1e-3, "kcycles", 1},
    FirstLimit{"L1 peak", "memory.l1.peak", 1e-3, "kB", 1},
    FirstLimit{"L2 peak", "memory.l2.peak", 1e-3, "kB", 1},
    FirstLimit{"energy per frame", "energy.frame", 1, "mJ", 4},
    FirstLimit{"ATE", "accuracy.ate.rmse", 1, "m", 4},
};

/// Not below the value, though it is rounded.
std::string rounded_up(double value, int decimals) {
  const double scale = std::pow(10, decimals);
  // A share of what is exact as written must not grow by a digit; no negative zero.
  const double digits = std::max(0.0, std::ceil(value * scale - 1e-6));
  return fmt::format("{:.{}f}", digits / scale, decimals);
}

}  // namespace

Budget parse_budget(const std::string& file, const std::string& text) {
  Budget budget = BudgetReader(file).read(text);
  budget.verdicts.name = "verdicts";
  for (const char* text_of_limit :
       {"time verdict <= fits on average", "memory verdict <= fits", "map verdict <= unreliable"}) {
    Limit& limit = budget.verdicts.limits.emplace_back(
        parse_limit(text_of_limit, platform::place_of(file, 1, "")));
    limit.file = file;
  }
  check_accepted(budget);
  return budget;
}

Budget read_budget(const std::string& file) {
  return parse_budget(file, base::read_file(file, base::InputKind::budget));
}

std::vector<const BudgetSection*> sections_for(const Budget& budget, const RunRecord& run) {
  std::vector<const BudgetSection*> found;
  std::vector<std::string> all;
  for (const BudgetSection& section : budget.sections) {
    all.push_back(fmt::format("{} on {}", section.profile, section.platform));
    if (matches(section.platform, run.facts.platform) &&
        matches(section.profile, run.facts.profile))
      found.push_back(&section);
  }
  if (found.empty())
    throw InputError(fmt::format(
        "{}: has no budget for {} on {}; there are those for {}", budget.file, run.facts.profile,
        run.facts.platform.empty() ? "the host" : run.facts.platform, fmt::join(all, ", ")));
  return found;
}

Limit parse_limit(const std::string& text, const platform::Place& place) {
  const auto at_most = text.find("<=");
  const auto at = std::min(at_most, text.find(">="));
  if (at == std::string::npos)
    place.fail(
        fmt::format("'{}' has neither <= nor >=; expected FIGURE <= NUMBER UNIT, such as "
                    "'frame latency p99 <= 45 ms' or 'cycles <= +3 %'",
                    text));
  Limit limit;
  limit.text = platform::trim(text);
  limit.figure = platform::trim(std::string_view(text).substr(0, at));
  limit.bound.at_most = at == at_most;
  std::string_view value = platform::trim(std::string_view(text).substr(at + 2));
  limit.bound.relative = !value.empty() && (value.front() == '+' || value.front() == '-');
  if (!value.empty() && value.front() == '+') value.remove_prefix(1);
  const auto measure = platform::split_measure(value);
  const bool is_of_verdict = limit.figure.ends_with(" verdict") && !value.empty() && !measure;
  if (is_of_verdict || std::any_of(verdict_words().begin(), verdict_words().end(),
                                   [&](const VerdictWord& w) { return w.word == value; })) {
    limit.bound.word = value;  // which check_figure() looks up
    return limit;
  }
  if (limit.figure.empty() || !measure || !(measure->number >= -1e18 && measure->number <= 1e18))
    place.fail(
        fmt::format("'{}': expected FIGURE <= NUMBER UNIT, such as 'L1 peak <= 110 kB'", text));
  limit.bound.number = measure->number;
  limit.bound.unit = measure->unit;
  return limit;
}

bool matches(const std::string& pattern, const std::string& text) {
  // The last '*' takes one more character each time that what follows it does not match.
  std::size_t p = 0;
  std::size_t t = 0;
  std::size_t star = std::string::npos;
  std::size_t taken = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string::npos) {
      p = star + 1;
      t = ++taken;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

std::string tightened(const Budget& budget, const std::string& text, const RunRecord& run,
                      double slack) {
  std::string edited = text;
  for (const BudgetSection* section : sections_for(budget, run))
    for (const Limit& limit : section->limits) {
      if (limit.bound.relative || !limit.bound.word.empty()) continue;
      const auto value = needed(limit, run);
      if (!value) continue;
      const std::string unit = figures_of(limit, run).front().statistic->unit;
      const bool up = limit.bound.at_most;
      const double wanted = *value * (1 + (up ? slack : -slack) / 100);
      const double bound = bound_in(limit, unit);
      if (up ? wanted >= bound : wanted <= bound) continue;
      Limit one = limit;
      one.bound.number = 1;
      // Lines before this one are as they were: entries are edited in place.
      std::size_t at = 0;
      for (int line = 1; line < limit.line; ++line) at = edited.find('\n', at) + 1;
      at = edited.find(limit.text, at);
      if (at == std::string::npos) continue;  // quoted with escapes
      edited.replace(at, limit.text.size(),
                     with_number(limit, rounded_to_side(wanted / bound_in(one, unit), up)));
    }
  return edited;
}

std::string parse_day(const std::string& where, const std::string& text) {
  std::tm day{};
  const char* const end = ::strptime(text.c_str(), "%Y-%m-%d", &day);
  const auto number = [](int value) { return static_cast<unsigned>(value); };
  const std::chrono::year_month_day date(std::chrono::year(day.tm_year + 1900),
                                         std::chrono::month(number(day.tm_mon + 1)),
                                         std::chrono::day(number(day.tm_mday)));
  if (end == nullptr || *end != '\0' || text.size() != 10 || !date.ok())  // February has no 30th
    throw InputError(fmt::format("{} '{}': expected a day such as 2026-12-24", where, text));
  return text;
}

std::string today() {
  const char* const epoch = std::getenv("SOURCE_DATE_EPOCH");
  const std::time_t now = epoch == nullptr ? std::time(nullptr) : std::atoll(epoch);
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(now));
}

std::string with_accepted(const std::string& text, const CheckResult& result,
                          const std::string& reason, const std::string& until) {
  std::string entries;
  const auto quoted = [](const std::string& words) { return json_text(Json(words)); };
  for (const Finding& finding : result.findings)
    if (finding.fails())
      entries += fmt::format("  - limit: {}\n    reason: {}\n    until: {}\n",
                             quoted(finding.title()), quoted(reason), parse_day("--until", until));
  if (entries.empty())
    throw InputError(
        fmt::format("budget accept: {} meets all limits of {}", result.run, result.budget));
  std::string edited = text;
  if (!edited.empty() && edited.back() != '\n') edited += '\n';
  const std::size_t at = edited.find("\n" + std::string(kAccepted));
  if (at == std::string::npos) return edited + std::string(kAccepted) + entries;
  return edited.insert(at + 1 + kAccepted.size(), entries);
}

std::string first_budget(const RunRecord& run, double margin) {
  const double factor = 1 + margin / 100;
  const auto quoted = [](const std::string& text) { return json_text(Json(text)); };
  std::string text = fmt::format(
      "# What the run needs, and {:g} % more. Give each limit its reason and owner.\n"
      "budgets:\n  - name: {}\n    platform: {}\n    profile: {}\n    limits:\n",
      margin, quoted(run.facts.profile + " on " + run.facts.platform), quoted(run.facts.platform),
      quoted(run.facts.profile));
  for (const FirstLimit& limit : kFirstLimits)
    if (const auto value = run.value(limit.statistic))
      text += fmt::format("      - {} <= {} {}\n", limit.figure,
                          rounded_up(*value * limit.scale * factor, limit.decimals), limit.unit);
  for (const RunVerdict& verdict : run.verdicts.list)  // a budget that says nothing refuses these
    if (verdict.grade == Grade::bad)
      text += fmt::format("      - {} verdict <= {}\n", verdict.about, verdict.word());
  for (const StageName& stage : run.stages)
    if (const auto value = run.value(fmt::format("stages.{}.cycles.parallel.mean", stage.key)))
      text += fmt::format("      - stage: {}\n        limit: cycles <= {} kcycles\n",
                          quoted(stage.name), rounded_up(*value * 1e-3 * factor, 1));
  return text;
}

double parse_share(const std::string& option, const std::string& text) {
  const auto measure = platform::split_measure(text);
  if (!measure || measure->unit != "%" || !(measure->number >= 0 && measure->number <= 1000))
    throw InputError(
        fmt::format("{} '{}': expected a share from 0 to 1000 %, such as 5 %", option, text));
  return measure->number;
}

}  // namespace leviosim::tools
