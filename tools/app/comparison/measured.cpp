#include "tools/app/comparison/measured.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/printable_text.h"
#include "tools/app/cli/terminal.h"
#include "tools/app/comparison/comparison_report.h"
#include "tools/app/report/text_table.h"
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

// A model against a measurement: the error of each stage.

std::vector<ModelError> model_errors(const RunComparison& c) {
  const bool is_a_reference = c.a.facts.measured;
  std::vector<ModelError> errors;
  const auto add = [&](const std::string& name, const std::optional<double>& a,
                       const std::optional<double>& b) {
    errors.push_back({name, is_a_reference ? a : b, is_a_reference ? b : a, std::nullopt});
    ModelError& e = errors.back();
    if (e.measured && e.model && *e.measured != 0)
      e.percent = 100 * (*e.model - *e.measured) / *e.measured;
  };
  for (const StageComparison& s : c.stages) add(s.stage.name, s.parallel.a, s.parallel.b);
  add("frame", c.frame.a, c.frame.b);
  return errors;
}

std::string measured_report(const RunComparison& c, bool markdown) {
  const bool is_a_reference = c.a.facts.measured;
  const RunRecord& measured = is_a_reference ? c.a : c.b;
  const RunRecord& other = is_a_reference ? c.b : c.a;
  const char* const what = other.facts.measured ? "other" : "model";
  const std::string bullet = markdown ? "- " : "";
  std::string text;
  const auto line = [&](const std::string& words) {
    text += bullet + (markdown ? words : shortened(words, kScreenColumns)) + '\n';
  };
  line("measured: " + printable(measured.name));
  line(fmt::format("{}: {}", what, printable(other.name)));
  for (const std::string& note : c.notes) line("note: " + printable(note));
  TextTable table({{"kcycles of a call", kLeft}, {"measured"}, {what}, {"error"}});
  std::vector<std::string> missing;
  double sum = 0;
  std::size_t stages = 0;
  const ModelError* worst = nullptr;
  const std::vector<ModelError> errors = model_errors(c);
  const auto kilo = [](std::optional<double> v) {
    return figure_text(v ? std::optional(*v / 1e3) : v, 1);
  };
  for (const ModelError& e : errors) {
    const bool is_frame = &e == &errors.back();
    if (!e.measured) {
      if (!is_frame && e.model) missing.push_back(printable(e.stage));
      continue;
    }
    table.add({shortened(e.stage, 30), kilo(e.measured), kilo(e.model),
               e.percent ? fmt::format("{:+.2f} %", *e.percent) : kNothing});
    if (is_frame || !e.percent) continue;
    ++stages;
    sum += std::abs(*e.percent);
    if (worst == nullptr || std::abs(*e.percent) > std::abs(*worst->percent)) worst = &e;
  }
  text += (markdown ? "\n" + table.markdown() + "\n" : table.str());
  if (!missing.empty()) {
    missing.front().insert(0, "not measured: ");
    for (std::size_t i = 0; i + 1 < missing.size(); ++i) missing[i] += ',';
    text += wrap(missing, " ", 2, kScreenColumns) + '\n';
  }
  if (worst == nullptr) return text + "in short: no stage is in both\n";
  return text +
         wrap({fmt::format("in short: {:.2f} % off on average of {} stages,",
                           sum / static_cast<double>(stages), stages),
               fmt::format("most in {} ({:+.2f} %)", printable(worst->stage), *worst->percent)},
              " ", 2, kScreenColumns) +
         (markdown ? "\n" : "\nnext: the same with --json, or both in leviosim check --baseline\n");
}

}  // namespace leviosim::tools
