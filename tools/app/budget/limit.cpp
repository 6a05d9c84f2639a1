#include "tools/app/budget/limit.h"

#include <fmt/format.h>

#include <algorithm>

#include "platform_models/loader/dimension.h"
#include "tools/app/result/verdict.h"

namespace leviosim::tools {

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
