#include "tools/app/budget/budget.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "platform_models/loader/schema.h"
#include "platform_models/loader/yaml_entries.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/nearest.h"
#include "tools/app/budget/budget_edits.h"
#include "tools/app/budget/figures.h"
#include "tools/app/result/verdict.h"

namespace leviosim::tools {
namespace {

using platform::Place;
using platform::YamlEntry;
using platform::YamlNode;

class BudgetReader {
 public:
  explicit BudgetReader(const std::string& file) { budget_.file = file; }

  Budget read(const std::string& text) {
    bool any = false;
    for (const YamlEntry& entry : entries(platform::parse_yaml(budget_.file, text), "")) {
      if (entry.key == "accepted") {
        for (const YamlNode& node : items(entry, "")) read_accepted(node);
        continue;
      }
      if (entry.key != "budgets") unknown(entry, "", {"budgets", "accepted"});
      any = true;
      for (const YamlNode& node : items(entry, "")) read_section(node);
    }
    if (!any || budget_.sections.empty())
      throw InputError(
          fmt::format("{}: has no budgets; expected a list of them under 'budgets'", budget_.file));
    return std::move(budget_);
  }

 private:
  std::vector<YamlEntry> entries(const YamlNode& node, const std::string& path) const {
    return platform::entries_of(node, budget_.file, path);
  }
  Place place(const YamlEntry& entry, const std::string& path) const {
    return platform::place_of(budget_.file, entry.line, platform::joined(path, entry.key));
  }
  [[noreturn]] void unknown(const YamlEntry& entry, const std::string& path,
                            const std::vector<std::string>& known) const {
    place(entry, path)
        .fail(fmt::format("unknown key{}; expected {}", base::did_you_mean(entry.key, known),
                          fmt::join(known, ", ")));
  }
  std::vector<YamlNode> items(const YamlEntry& entry, const std::string& path) const {
    if (!entry.value.is_sequence())
      place(entry, path)
          .fail(fmt::format("is {}; expected a list", platform::kind_of(entry.value)));
    return entry.value.items();
  }
  std::string text(const YamlEntry& entry, const std::string& path) const {
    return platform::scalar(entry.value, place(entry, path));
  }

  void read_section(const YamlNode& node) {
    BudgetSection section;
    std::string reason;
    std::string owner;
    for (const YamlEntry& entry : entries(node, "budgets")) {
      if (entry.key == "name")
        section.name = text(entry, "budgets");
      else if (entry.key == "platform")
        section.platform = text(entry, "budgets");
      else if (entry.key == "profile")
        section.profile = text(entry, "budgets");
      else if (entry.key == "reason")
        reason = text(entry, "budgets");
      else if (entry.key == "owner")
        owner = text(entry, "budgets");
      else if (entry.key == "limits")
        for (const YamlNode& limit : items(entry, "budgets"))
          section.limits.push_back(read_limit(limit));
      else
        unknown(entry, "budgets", {"name", "platform", "profile", "reason", "owner", "limits"});
    }
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
    for (const YamlEntry& entry : entries(node, "accepted"))
      if (entry.key == "limit")
        miss.limit = text(entry, "accepted");
      else if (entry.key == "reason")
        miss.reason = text(entry, "accepted");
      else if (entry.key == "until")
        miss.until = parse_day(fmt::format("{}:{}: until", budget_.file, entry.line),
                               text(entry, "accepted"));
      else
        unknown(entry, "accepted", {"limit", "reason", "until"});
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
      std::string stage;
      std::string level = "fail";
      std::string reason;
      std::string owner;
      for (const YamlEntry& entry : entries(node, "limits")) {
        if (entry.key == "limit")
          limit = parse_limit(text(entry, "limits"), place(entry, "limits"));
        else if (entry.key == "stage")
          stage = text(entry, "limits");
        else if (entry.key == "level")
          level = text(entry, "limits");
        else if (entry.key == "reason")
          reason = text(entry, "limits");
        else if (entry.key == "owner")
          owner = text(entry, "limits");
        else
          unknown(entry, "limits", {"limit", "stage", "level", "reason", "owner"});
      }
      if (limit.text.empty()) here.fail("has no 'limit'");
      if (level != "fail" && level != "warn")
        here.fail(fmt::format("level '{}': expected fail or warn", level));
      limit.warns = level == "warn";
      limit.stage = stage;
      limit.reason = reason;
      limit.owner = owner;
    }
    limit.file = budget_.file;
    limit.line = node.line();
    check_figure(limit);
    return limit;
  }

  Budget budget_;
};

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
  if (std::any_of(verdict_words().begin(), verdict_words().end(),
                  [&](const VerdictWord& w) { return w.word == value; })) {
    limit.bound.word = value;
    return limit;
  }
  const auto measure = platform::split_measure(value);
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
