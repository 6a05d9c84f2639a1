#include "tools/app/study/systems/published_systems.h"

#include <fmt/core.h>

#include <sstream>

#include "sim/base/csv.h"
#include "tools/app/validation/builtin_references.h"

namespace leviosim::tools {
namespace {

const std::vector<std::string> kColumns{"system",       "year",     "class", "chip",
                                        "frames_per_s", "power_mw", "bound", "workload",
                                        "platform",     "set",      "source"};
enum Column : std::size_t {
  kSystem,
  kYear,
  kClass,
  kChip,
  kRate,
  kPower,
  kBound,
  kWorkload,
  kPlatform,
  kSet,
  kSource
};

std::optional<double> positive(const base::CsvRow& row, Column column) {
  if (row.text(column).empty()) return std::nullopt;
  const double value = row.number(column);
  if (!(value > 0)) row.fail(column, "expected a number above 0, or nothing");
  return value;
}

PublishedSystem system_from(const base::CsvRow& row) {
  PublishedSystem system;
  system.name = row.text(kSystem);
  system.year = static_cast<int>(row.number(kYear));
  system.kind = row.text(kClass);
  system.chip = row.text(kChip);
  system.frames_per_s = positive(row, kRate);
  system.power_mw = positive(row, kPower);
  const std::string bound(row.text(kBound));
  if (!bound.empty() && bound != "at most") row.fail(kBound, "expected 'at most', or nothing");
  system.is_bound = !bound.empty();
  system.workload = row.text(kWorkload);
  system.platform = row.text(kPlatform);
  if (system.workload.empty() != system.platform.empty())
    row.fail(kPlatform, "expected a workload and a platform, or neither");
  std::istringstream words{std::string(row.text(kSet))};
  for (std::string word; words >> word;) system.overrides.push_back(word);
  system.source = row.text(kSource);
  if (system.name.empty() || system.source.empty()) row.fail("has no name or no source");
  return system;
}

}  // namespace

std::optional<double> PublishedSystem::frame_mj() const {
  if (!frames_per_s || !power_mw) return std::nullopt;
  return *power_mw / *frames_per_s;
}

std::vector<PublishedSystem> parse_systems(const std::string& file, std::string_view text) {
  base::CsvReader reader(file, base::Separator::comma, kColumns, std::string(text));
  const base::CsvRow* header = reader.next();
  for (std::size_t i = 0; header != nullptr && i < kColumns.size(); ++i)
    if (header->text(i) != kColumns[i])
      header->fail(i, fmt::format("expected the title {}", kColumns[i]));
  std::vector<PublishedSystem> systems;
  while (const base::CsvRow* row = reader.next()) systems.push_back(system_from(*row));
  return systems;
}

std::vector<PublishedSystem> published_systems() {
  return parse_systems("systems.csv", reference_text("systems"));
}

}  // namespace leviosim::tools
