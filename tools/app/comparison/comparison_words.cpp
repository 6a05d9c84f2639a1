#include "tools/app/comparison/comparison_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "sim/base/printable.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {

std::string quantity_text(std::optional<double> value, const std::string& unit, int decimals) {
  return unit == "m" ? metres_text(value, decimals) : figure_text(value, decimals);
}

std::string signed_percent(std::optional<double> value) {
  if (!value) return kNothing;
  if (std::abs(*value) < 0.005) return *value == 0 ? "0" : "±0.00 %";
  return fmt::format("{:+.2f} %", *value);
}

std::string part_label(const std::string& name) {
  const std::string_view meaning = describe_mechanism(name);
  return meaning.empty() ? name : std::string(meaning);
}

std::string work_line(const RunComparison& comparison) {
  if (comparison.stages.empty()) return "work: not counted in a native run";
  if (comparison.same_work())
    return "work: the same operations and calls in all stages; what differs is their cost";
  std::vector<std::string> changes;
  std::vector<std::string> moved;
  for (const StageComparison& s : comparison.stages) {
    if (s.same_work) continue;
    if (!s.offloaded.empty() && s.calls.a == s.calls.b) {
      moved.push_back(fmt::format("{} {}", printable(s.stage.name), fmt::join(s.offloaded, ", ")));
      continue;
    }
    std::string change = printable(s.stage.name);
    if (s.calls.a != s.calls.b)
      change +=
          fmt::format(" {} → {} calls,", figure_text(s.calls.a, 0), figure_text(s.calls.b, 0));
    changes.push_back(change +
                      fmt::format(" operations {}", signed_percent(s.operations.percent())));
  }
  const std::string offloaded =
      moved.empty() ? "" : fmt::format("work moved: {}", fmt::join(moved, "; "));
  if (changes.empty()) return offloaded;
  return fmt::format("work: CHANGED in {} of {} stages: {}{}{}", changes.size(),
                     comparison.stages.size(), fmt::join(changes, "; "),
                     offloaded.empty() ? "" : "; ", offloaded);
}

std::vector<std::string> reasons(const StageComparison& stage, std::size_t most, Toward toward) {
  std::vector<std::string> list;
  if (!stage.mechanisms || stage.mechanisms->a.value_or(0) == 0) return list;
  const double whole = *stage.mechanisms->a;
  for (const Leaf& leaf : leaves_by_difference(*stage.mechanisms)) {
    if (list.size() == most || std::abs(leaf.difference) < kLeastShare * whole) break;
    if (toward == Toward::more && leaf.difference < 0) continue;
    if (leaf.name == kOtherParts && !list.empty()) continue;  // says nothing beside a reason
    list.push_back(
        fmt::format("{} {:+.2f} %", part_label(leaf.name), 100 * leaf.difference / whole));
  }
  return list;
}

}  // namespace leviosim::tools
