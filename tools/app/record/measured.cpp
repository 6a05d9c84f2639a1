#include "tools/app/record/measured.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFrame = "frame";

/// All rows of a stage.
struct MeasuredStage {
  std::string name;
  double cycles = 0;
  double calls = 0;
  double worst = 0;
  std::size_t rows = 0;
};

/// What a comment "# KEY: value" says; empty if there is none.
std::string comment(std::string_view text, std::string_view key) {
  constexpr std::string_view kBlanks = " \t\r";
  const auto trimmed = [&](std::string_view words) {
    const auto begin = words.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return std::string_view();
    return words.substr(begin, words.find_last_not_of(kBlanks) - begin + 1);
  };
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const auto colon = line.find(':');
    if (!line.starts_with('#') || colon == std::string_view::npos) continue;
    if (trimmed(line.substr(1, colon - 1)) == key)
      return std::string(trimmed(line.substr(colon + 1)));
  }
  return {};
}

void add_row(const base::CsvRow& row, bool has_calls, std::vector<MeasuredStage>& stages) {
  const std::string name(row.text(0));
  if (key_of(name).empty()) row.fail(0, "no name of a stage");
  const double cycles = row.number(1);
  const double calls = has_calls ? row.number(2) : 1;
  if (cycles < 0) row.fail(1, "below zero");
  if (calls < 1) row.fail(2, "below one");
  const auto known = std::find_if(stages.begin(), stages.end(), [&](const MeasuredStage& s) {
    return key_of(s.name) == key_of(name);
  });
  MeasuredStage& stage = known != stages.end() ? *known : stages.emplace_back();
  stage.name = name;
  stage.cycles += cycles * calls;
  stage.calls += calls;
  stage.worst = std::max(stage.worst, cycles);
  ++stage.rows;
}

std::vector<MeasuredStage> read_stages(const std::string& file, std::string text) {
  const base::FirstRow first = base::first_row(file);
  const bool has_calls = first.columns == 3;
  std::vector<std::string> names{"stage", "cycles"};
  if (has_calls) names.emplace_back("calls");
  base::CsvReader rows(file, base::Separator::comma, names, std::move(text));
  const base::CsvRow* const titles = rows.next();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (titles->text(i) != names[i])
      titles->fail("expected the titles stage,cycles or stage,cycles,calls");
  std::vector<MeasuredStage> stages;
  while (const base::CsvRow* row = rows.next()) add_row(*row, has_calls, stages);
  if (stages.empty())
    throw InputError(fmt::format("{}: has no measurement below its titles", file));
  for (MeasuredStage& stage : stages)
    if (!has_calls && stage.rows == 1) stage.calls = 0;  // a mean, of nobody knows how many
  return stages;
}

}  // namespace

bool is_measured(const std::string& name) { return name.ends_with(".csv") && base::is_file(name); }

RunRecord read_measured(const std::string& file) {
  const std::string text = base::read_file(file, base::InputKind::table);
  RunRecord record;
  record.name = file;
  record.facts.measured = true;
  record.facts.profile = comment(text, "profile");
  record.facts.platform = comment(text, "platform");
  for (const MeasuredStage& stage : read_stages(file, text)) {
    const std::string key = key_of(stage.name);
    const double count = stage.calls > 0 ? stage.calls : 1;
    const bool is_frame = key == kFrame;
    const std::string path = is_frame ? "frame." : fmt::format("stages.{}.", key);
    const auto add = [&](const char* name, const char* unit, double value) {
      record.statistics.push_back({path + name, unit, "", value});
    };
    if (!is_frame) record.stages.push_back({stage.name, key, false});
    add("cycles.parallel.mean", "cycles", stage.cycles / count);
    if (is_frame || stage.calls == 0) continue;
    add("calls", "1", stage.calls);
    if (stage.rows > 1) add("cycles.parallel.worst", "cycles", stage.worst);
  }
  return record;
}

void name_stages_like(RunRecord& measured, const RunRecord& run) {
  if (!measured.facts.measured) return;
  for (StageName& stage : measured.stages)
    for (const StageName& known : run.stages)
      if (known.key == stage.key) stage.name = known.name;
}

}  // namespace leviosim::tools
