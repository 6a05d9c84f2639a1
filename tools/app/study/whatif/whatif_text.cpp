#include "tools/app/study/whatif/whatif_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "sim/base/printable.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr int kWidth = 80;
constexpr int kIndent = 4;
constexpr int kNameWidth = 28;
/// Per cent of the time; less is no change.
constexpr double kNoChange = 0.05;
/// Per cent of the time; an advice has no row for less.
constexpr double kWorthARow = 1;
/// Of the whole difference: a cause with less goes without saying.
constexpr double kLeastCause = 0.2;

std::optional<double> percent(double value, double base) {
  if (base == 0) return std::nullopt;
  return 100 * (value / base - 1);
}

struct Changes {
  double time = 0;
  std::optional<double> energy;
  std::optional<double> area;
};

Changes changes_of(const VariantResult& base, const VariantResult& variant) {
  Changes changes{percent(variant.mean_ms(), base.mean_ms()).value_or(0), {}, {}};
  if (base.energy_mj && variant.energy_mj)
    changes.energy = percent(variant.energy_mj->value, base.energy_mj->value);
  if (base.area_mm2 && variant.area_mm2) changes.area = percent(*variant.area_mm2, *base.area_mm2);
  return changes;
}

std::string wrapped(const std::string& text) {
  return std::string(kIndent, ' ') + wrap_words(text, kIndent, kWidth) + '\n';
}

std::string below(const VariantResult& base, const VariantResult& variant) {
  std::string text;
  if (display_width(printable(variant.name)) > kNameWidth) text = printable(variant.name) + ": ";
  if (!variant.failure.empty()) return wrapped(text + printable(variant.failure));
  if (!variant.raised.empty())
    text += fmt::format("with {}, which it needs: ", fmt::join(variant.raised, " and "));
  const Changes changes = changes_of(base, variant);
  text += std::abs(changes.time) < kNoChange ? "same time"
                                             : fmt::format("{:+.1f} % time", changes.time);
  if (changes.energy) text += fmt::format(", {:+.1f} % energy", *changes.energy);
  if (!variant.is_whole_area)
    text += ", area of some parts unknown";
  else if (changes.area)
    text += fmt::format(", {:+.1f} % area", *changes.area);
  return wrapped(text + ": " + reason_of(base, variant));
}

std::string number(std::optional<double> value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "–";
}

std::vector<Cell> cells_of(const VariantResult& result) {
  const std::string name = shortened(printable(result.name), kNameWidth);
  if (!result.failure.empty()) return {name, "–", "–", "–", "cannot run", "–", "–"};
  std::optional<double> energy;
  if (result.energy_mj) energy = result.energy_mj->value;
  return {name,
          number(result.mean_ms(), 2),
          number(result.times.p99_ns.value * 1e-6, 2),
          number(result.times.sustainable_rate(), 1),
          result.verdict(),
          number(energy, 3),
          (result.is_whole_area ? "" : ">") + number(result.area_mm2, 2)};
}

/// Rows with a line of reasons below each but the first.
std::string table_of(const VariantResult& base, const std::vector<const VariantResult*>& rows) {
  Table table({{"", kLeft},
               {"mean ms", kRight},
               {"p99 ms", kRight, 2},
               {"fps", kRight, 3},
               {"verdict", kLeft},
               {"mJ", kRight, 1},
               {"mm2", kRight, 1}});
  table.add(cells_of(base));
  for (const VariantResult* row : rows) table.add(cells_of(*row));
  const std::string lines = terminal_text(table, std::min(table_width(), kWidth));
  std::string text;
  std::size_t begin = 0;
  constexpr std::size_t kBefore = 3;  // titles, rule, the run as it is
  for (std::size_t line = 0; begin < lines.size(); ++line) {
    const std::size_t end = lines.find('\n', begin) + 1;
    text += lines.substr(begin, end - begin);
    if (line >= kBefore) text += below(base, *rows[line - kBefore]);
    begin = end;
  }
  return text;
}

/// Time gained per area. What needs no area comes first, what needs an unknown one last; of both
/// the fastest first.
std::pair<int, double> worth(const VariantResult& base, const VariantResult& variant) {
  const Changes changes = changes_of(base, variant);
  if (!changes.area || !variant.is_whole_area) return {0, -changes.time};
  return *changes.area > 0 ? std::pair(1, -changes.time / *changes.area)
                           : std::pair(2, -changes.time);
}

std::string list_of(const std::string& title, const std::vector<std::string>& items) {
  if (items.empty()) return {};
  return title + '\n' + wrapped(fmt::format("{}", fmt::join(items, "; ")));
}

/// "cluster.icache.shared_size=8KiB: -8.4 % time, +0.2 % area, 1 late frame for 7".
std::string gain_text(const VariantResult& base, const VariantResult& variant) {
  const Changes changes = changes_of(base, variant);
  std::string text = fmt::format("{}: {:+.1f} % time", printable(variant.name), changes.time);
  if (changes.area && variant.is_whole_area) text += fmt::format(", {:+.1f} % area", *changes.area);
  if (variant.times.late != base.times.late)
    text += fmt::format(", {} late frame{} for {}", variant.times.late,
                        variant.times.late == 1 ? "" : "s", base.times.late);
  return text;
}

/// " (+1.4 % area, +5.5 % energy)"; what is not known is left out.
std::string price_text(const Changes& changes) {
  std::vector<std::string> parts;
  if (changes.area) parts.push_back(fmt::format("{:+.1f} % area", *changes.area));
  if (changes.energy) parts.push_back(fmt::format("{:+.1f} % energy", *changes.energy));
  return parts.empty() ? "" : fmt::format(" ({})", fmt::join(parts, ", "));
}

/// Variants by what they do to the time of a mean frame.
struct Ranking {
  std::vector<const VariantResult*> gains;  ///< of kWorthARow or more, the fastest first
  std::vector<std::string> small, spared, same, wasted, slower, impossible;
  const VariantResult* most_useless = nullptr;  ///< costs area, gains nothing
};

Ranking ranked(const std::vector<VariantResult>& results) {
  const VariantResult& base = results.front();
  Ranking rank;
  double most_wasted = 0;
  for (std::size_t i = 1; i < results.size(); ++i) {
    const VariantResult& result = results[i];
    const std::string name = printable(result.name);
    if (!result.failure.empty()) {
      rank.impossible.push_back(fmt::format("{} ({})", name, printable(result.failure)));
      continue;
    }
    const Changes changes = changes_of(base, result);
    if (changes.time <= -kWorthARow) {
      rank.gains.push_back(&result);
    } else if (changes.time <= -kNoChange) {
      rank.small.push_back(fmt::format("{} {:+.1f} %", name, changes.time));
    } else if (changes.time >= kNoChange) {
      rank.slower.push_back(fmt::format("{} {:+.1f} %", name, changes.time));
    } else if (changes.area.value_or(0) < 0) {
      rank.spared.push_back(name + price_text(changes));
    } else if (changes.area.value_or(0) > 0 || changes.energy.value_or(0) >= kNoChange) {
      rank.wasted.push_back(name + price_text(changes));
    } else {
      rank.same.push_back(name);
    }
    if (changes.time > -kWorthARow && changes.time < kWorthARow &&
        changes.area.value_or(0) > most_wasted) {
      most_wasted = *changes.area;
      rank.most_useless = &result;
    }
  }
  std::stable_sort(rank.gains.begin(), rank.gains.end(),
                   [](const auto* a, const auto* b) { return a->mean_ms() < b->mean_ms(); });
  return rank;
}

/// Of stages: "in tiles: world matching, triangulation and 2 more".
std::string tiled_text(const std::vector<std::string>& stages) {
  constexpr std::size_t kMost = 3;
  if (stages.empty()) return "nothing passes in tiles";
  const std::size_t named = stages.size() > kMost ? kMost - 1 : stages.size();
  std::string text = fmt::format(
      "in tiles: {}",
      fmt::join(stages.begin(), stages.begin() + static_cast<std::ptrdiff_t>(named), ", "));
  if (named < stages.size()) text += fmt::format(" and {} more", stages.size() - named);
  return text;
}

}  // namespace

std::string reason_of(const VariantResult& base, const VariantResult& variant) {
  if (!variant.failure.empty()) return variant.failure;
  const double difference = variant.mean_ms() - base.mean_ms();
  std::vector<std::string> parts;
  double explained = 0;
  if (std::abs(difference) >= kNoChange * 1e-2 * base.mean_ms())
    for (const MainCause& cause : main_causes(base.parts, variant.parts)) {
      // One that is small goes unsaid, unless what was said does not add up without it.
      const bool is_small = std::abs(cause.ms) < kLeastCause * std::abs(difference);
      const bool adds_up =
          std::abs(difference - explained) < kLeastCause / 2 * std::abs(difference);
      if (parts.size() == 2 || (is_small && (parts.empty() || adds_up))) break;
      explained += cause.ms;
      parts.push_back(cause_text(cause));
    }
  if (std::string unused = unused_text(base.unused, variant.unused); !unused.empty())
    parts.push_back(std::move(unused));
  if (variant.tiled != base.tiled) parts.push_back(tiled_text(variant.tiled));
  if (parts.empty()) return "no frame waits for it";
  return fmt::format("{}", fmt::join(parts, "; "));
}

std::string whatif_conclusion(const std::vector<VariantResult>& results) {
  const VariantResult* fastest = nullptr;
  for (std::size_t i = 1; i < results.size(); ++i) {
    if (!results[i].failure.empty()) continue;
    if (fastest == nullptr || results[i].mean_ms() < fastest->mean_ms()) fastest = &results[i];
  }
  if (fastest == nullptr) return "verdict: none of the variants can run";
  if (changes_of(results.front(), *fastest).time > -kNoChange)
    return fmt::format("in short: no variant is faster than {:.2f} ms", results.front().mean_ms());
  return fmt::format("in short: {}{}", results.size() > 2 ? "fastest is " : "",
                     gain_text(results.front(), *fastest));
}

std::string whatif_table(const std::vector<VariantResult>& results) {
  std::vector<const VariantResult*> rows;
  for (std::size_t i = 1; i < results.size(); ++i) rows.push_back(&results[i]);
  return table_of(results.front(), rows);
}

std::string advice_conclusion(const std::vector<VariantResult>& results) {
  const VariantResult& base = results.front();
  const Ranking rank = ranked(results);
  if (rank.gains.empty())
    return fmt::format("in short: nothing gains {:.0f} % of {:.2f} ms", kWorthARow, base.mean_ms());
  std::vector<const VariantResult*> by_worth = rank.gains;
  std::stable_sort(by_worth.begin(), by_worth.end(),
                   [&](const auto* a, const auto* b) { return worth(base, *a) > worth(base, *b); });
  std::erase(by_worth, rank.gains.front());
  std::vector<std::string> texts{"fastest is " + gain_text(base, *rank.gains.front())};
  for (std::size_t i = 0; i < std::min<std::size_t>(2, by_worth.size()); ++i)
    texts.push_back((i == 0 ? "most per area: " : "then ") + gain_text(base, *by_worth[i]));
  if (rank.most_useless != nullptr)
    texts.push_back(printable(rank.most_useless->name) + " brings nothing");
  return fmt::format("in short: {}", fmt::join(texts, "; "));
}

std::string advice_text(const std::vector<VariantResult>& results) {
  const VariantResult& base = results.front();
  const Ranking rank = ranked(results);
  std::string text = table_of(base, rank.gains);
  std::vector<const VariantResult*> by_energy = rank.gains;
  std::stable_sort(by_energy.begin(), by_energy.end(), [&](const auto* a, const auto* b) {
    const auto of = [&](const VariantResult& r) {
      return changes_of(base, r).energy.value_or(std::numeric_limits<double>::max());
    };
    return of(*a) < of(*b);
  });
  std::vector<std::string> least;
  for (const VariantResult* r : by_energy)
    if (const auto energy = changes_of(base, *r).energy; energy && least.size() < 3)
      least.push_back(fmt::format("{} {:+.1f} %", r->name, *energy));
  text += list_of("Least energy per frame:", least);
  text += list_of(fmt::format("Gains less than {:.0f} %:", kWorthARow), rank.small);
  text += list_of("Costs no time:", rank.spared);
  text += list_of("Gains no time, but costs:", rank.wasted);
  text += list_of("Changes nothing:", rank.same);
  text += list_of("Takes longer:", rank.slower);
  return text + list_of("Cannot run:", rank.impossible);
}

}  // namespace leviosim::tools
