#include "tools/app/budget/budget.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "platform_models/loader/parameter_units.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/nearest_name.h"
#include "tools/app/budget/day.h"
#include "tools/app/budget/figures.h"
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
    map.check_keys({"limit", "bound", "reason", "until"});
    map.read("limit", miss.limit);
    if (const YamlMap::Entry* bound = map.find("bound"))
      miss.bound = read_bound(map.text(*bound), map.place(*bound));
    map.read("reason", miss.reason);
    if (const YamlMap::Entry* until = map.find("until"))
      miss.until =
          parse_day(fmt::format("{}:{}: until", budget_.file, until->line), map.text(*until));
    miss.line = node.line();
    if (miss.limit.empty() || miss.reason.empty() || miss.until.empty())
      platform::place_of(budget_.file, node.line(), "accepted")
          .fail("expected limit, reason and until");
  }

  /// "61.7 ms", of which the limit says whether it is the most or the least.
  static Bound read_bound(const std::string& text, const Place& place) {
    const auto measure = platform::split_measure(text);
    if (!measure || !std::isfinite(measure->number))
      place.fail(fmt::format("'{}': expected a number with its unit, such as 61.7 ms", text));
    return {.number = measure->number, .unit = std::string(measure->unit)};
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

}  // namespace leviosim::tools
