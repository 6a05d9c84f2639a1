#include "tools/app/budget/gate.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <set>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "tools/app/budget/figures.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/report/json_reader.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFormat = "leviosim baseline";
constexpr double kLeastStageShare = 0.01;

std::set<std::string> names_in_baseline(const RunRecord& run, const Budget* budget) {
  std::set<std::string> names{"frames.count", "run.frame_period", "run.cluster_clock",
                              "energy.total"};
  for (const FigurePhrase& p : run_phrases()) names.emplace(p.statistic);
  for (const StageName& stage : run.stages)
    for (const char* statistic :
         {"stages.{}.calls", "stages.{}.operations", "stages.{}.cycles.single.mean",
          "stages.{}.cycles.parallel.mean", "stages.{}.memory.parallel", "energy.{}.call"})
      names.insert(fmt::format(fmt::runtime(statistic), stage.key));
  if (budget != nullptr)
    for (const BudgetSection* section : sections_for(*budget, run))
      for (const Limit& limit : section->limits)
        for (const FigureOf& figure : figures_of(limit, run)) names.insert(figure.statistic->name);
  const StageName* fullest = fullest_stage(run);
  const std::string blocks =
      fullest == nullptr ? "" : fmt::format("stages.{}.memory.block.", fullest->key);
  for (const Statistic& s : run.statistics) {
    if (!blocks.empty() && s.name.starts_with(blocks)) names.insert(s.name);
    if (matches("memory.l2.*.bytes", s.name)) names.insert(s.name);
  }
  return names;
}

/// The shortest text; whole numbers without a fraction.
Json number_json(std::optional<double> value) {
  constexpr double kExact = 9007199254740992;  // 2^53
  if (value && *value == std::floor(*value) && std::abs(*value) < kExact)
    return static_cast<std::int64_t>(*value);
  return value_of(value);
}

/// What a part is in one word: "issue f32_fma".
std::string part_key(const CyclePart& part) {
  return part.operation.empty() ? part.mechanism : part.mechanism + ' ' + part.operation;
}

Json part_json(const CyclePart& part) {
  const auto whole = [](double v) { return static_cast<std::int64_t>(std::llround(v)); };
  if (part.count == 0) return whole(part.cycles);
  return Json::array({whole(part.cycles), whole(part.count)});
}

std::string stage_lines(const StageName& name, const StageParts& stage) {
  std::string text = fmt::format(
      "  {{\"name\": {}, \"key\": {}, \"controller\": {}, \"cycles\": {},", json_text(stage.stage),
      json_text(name.key), stage.on_controller, json_text(number_json(stage.cycles)));
  text += " \"parts\": {";
  const StageParts kept = folded(stage, kLeastStageShare);
  std::vector<std::string> places;
  for (const CyclePart& part : kept.parts)
    if (std::find(places.begin(), places.end(), part.where) == places.end())
      places.push_back(part.where);
  for (std::size_t i = 0; i < places.size(); ++i) {
    Json parts = Json::object();
    for (const CyclePart& part : kept.parts)
      if (part.where == places[i]) parts[part_key(part)] = part_json(part);
    text +=
        fmt::format("{}\n    {}: {}", i == 0 ? "" : ",", json_text(places[i]), json_text(parts));
  }
  return text + "}}";
}

StageParts stage_of(const Json& json) {
  StageParts stage{json.at("name").get<std::string>(),
                   json.at("controller").get<bool>(),
                   json.at("cycles").get<double>(),
                   {}};
  double listed = 0;
  for (const auto& [where, parts] : json.at("parts").items())
    for (const auto& [key, value] : parts.items()) {
      const auto blank = key.find(' ');
      CyclePart part{where, key.substr(0, blank),
                     blank == std::string::npos ? "" : key.substr(blank + 1), 0, 0};
      part.cycles = value.is_array() ? value.at(0).get<double>() : value.get<double>();
      if (value.is_array()) part.count = value.at(1).get<double>();
      if (describe_mechanism(part.mechanism).empty()) throw InputError("");
      listed += part.cycles;
      stage.parts.push_back(std::move(part));
    }
  // Rounding to whole cycles is nobody's.
  stage.parts.push_back({"", "other", "", 0, 0});
  stage.parts.back().cycles = stage.cycles - listed;
  return stage;
}

void add_figures(const Json& figures, RunRecord& run) {
  for (const auto& [name, value] : figures.items())
    run.statistics.push_back(
        {name, value.at(1).get<std::string>(), "",
         value.at(0).is_null() ? std::nullopt : std::optional<double>(value.at(0).get<double>())});
}

void expect_cycles(const RunRecord& run) {
  if (run.cycles.empty() && !run.facts.measured)
    throw InputError(fmt::format(
        "{}: has no {}, so a baseline of it could not say why a limit is not met; run or replay it "
        "again",
        run.name, kCyclesFile));
}

/// Without a key: what is no stage.
StageName name_of(const StageParts& parts, const RunRecord& run) {
  for (const StageName& stage : run.stages)
    if (stage.name == parts.stage) return stage;
  return {};
}

bool is_of(const StageName& stage, const std::string& statistic) {
  return statistic.starts_with("stages." + stage.key + '.') ||
         statistic.starts_with("energy." + stage.key + '.');
}

bool is_of_a_stage(const std::string& statistic, const RunRecord& run) {
  return std::any_of(run.stages.begin(), run.stages.end(),
                     [&](const StageName& stage) { return is_of(stage, statistic); });
}

RunRecord record_of_baseline(const std::string& name, const Json& document) {
  RunRecord run;
  run.name = name;
  run.facts = facts_of_json(name, document.at("facts"));
  add_figures(document.at("statistics"), run);
  for (const Json& stage : document.at("stages")) add_baseline_stage(stage, run);
  return run;
}

/// Baselines are JSON, traces begin with letters.
bool is_baseline(const std::string& name) { return base::is_file(name) && name.ends_with(".json"); }

}  // namespace

std::vector<BaselineFigure> baseline_figures(const RunRecord& run) {
  const std::set<std::string> names = names_in_baseline(run, nullptr);
  std::vector<BaselineFigure> figures;
  for (const Statistic& s : run.statistics)
    if (names.count(s.name) > 0 && !is_of_a_stage(s.name, run))
      figures.push_back({s.name, s.unit, number_json(s.value)});
  return figures;
}

std::vector<Json> baseline_stages(const RunRecord& run) {
  expect_cycles(run);
  const std::set<std::string> names = names_in_baseline(run, nullptr);
  std::vector<Json> stages;
  const auto add = [&](const StageName& name, Json stage) {
    stage["figures"] = Json::object();
    for (const Statistic& s : run.statistics)
      if (names.count(s.name) > 0 && !name.key.empty() && is_of(name, s.name))
        stage["figures"][s.name] = {number_json(s.value), s.unit};
    stages.push_back(std::move(stage));
  };
  for (const StageParts& parts : run.cycles) {
    const StageName name = name_of(parts, run);
    add(name, Json::parse(stage_lines(name, parts)));
  }
  for (const StageName& name : run.stages)
    if (run.stage_parts(name.name) == nullptr)
      add(name, {{"name", name.name}, {"key", name.key}, {"controller", name.on_controller}});
  return stages;
}

void add_baseline_stage(const Json& stage, RunRecord& run) {
  if (stage.contains("cycles")) run.cycles.push_back(stage_of(stage));
  const auto key = stage.at("key").get<std::string>();
  if (!key.empty())
    run.stages.push_back(
        {stage.at("name").get<std::string>(), key, stage.at("controller").get<bool>()});
  if (stage.contains("figures")) add_figures(stage.at("figures"), run);
}

std::string baseline_text(const RunRecord& run, const Budget* budget) {
  expect_cycles(run);
  const std::set<std::string> names = names_in_baseline(run, budget);
  std::string statistics;
  for (const Statistic& s : run.statistics)
    if (names.count(s.name) > 0)
      statistics +=
          fmt::format("{}  {}: [{}, {}]", statistics.empty() ? "\n" : ",\n", json_text(s.name),
                      json_text(number_json(s.value)), json_text(s.unit));
  std::string stages;
  for (const StageParts& parts : run.cycles)
    stages += (stages.empty() ? "\n" : ",\n") + stage_lines(name_of(parts, run), parts);
  return fmt::format(
      "{{\"format\": \"{}\", \"version\": 1,\n\"facts\": {},\n\"statistics\": {{{}\n}},\n"
      "\"stages\": [{}\n]}}\n",
      kFormat, json_text(facts_json(run.facts)), statistics, stages);
}

RunRecord parse_baseline(const std::string& name, const std::string& text) {
  const Json document = read_json(name, text);
  try {
    if (document.at("format") == kFormat && document.at("version") == 1)
      return record_of_baseline(name, document);
  } catch (const nlohmann::json::exception&) {
  } catch (const InputError&) {
  }
  throw InputError(fmt::format(
      "{}: no baseline of version 1; expected what 'leviosim budget record' prints", name));
}

RunRecord read_run_or_baseline(const std::string& name, const RecordOptions& chip) {
  if (is_baseline(name))
    return parse_baseline(name, base::read_file(name, base::InputKind::baseline));
  return read_record(name, chip);
}

void add_gate_options(CLI::App& command, GateOptions& options) {
  const TextOptions add{command};
  add("--budget", options.budget, "FILE", "limits that the run has to meet");
  add("--baseline", options.baseline, "RUN|FILE.json",
      "what limits with a sign are relative to: a run, or what budget record printed");
  add("--allow", options.allow, "chip,data,frames,profile,seed,size",
      "differences of the baseline's input that are meant");
}

Gate::Gate(const GateOptions& options, const RecordOptions& chip)
    : budget_(read_budget(options.budget)), allowed_(parse_allowed(options.allow)) {
  if (options.baseline.empty()) return;
  is_kept_ = true;
  if (base::is_folder(options.baseline) || is_measured(options.baseline))
    baseline_ = read_record(options.baseline, {});
  else if (options.baseline.ends_with(".yaml") && base::is_file(options.baseline))
    throw InputError(fmt::format(
        "--baseline {}: is no baseline; expected a run folder, a work trace, or a JSON file that "
        "'leviosim budget record' printed",
        options.baseline));
  else
    baseline_ = read_run_or_baseline(options.baseline, chip);
}

void Gate::use_baseline(RunRecord baseline) {
  if (!baseline_) baseline_ = std::move(baseline);
}

CheckResult Gate::check(const RunRecord& of) const {
  RunRecord run = of;
  std::optional<RunRecord> baseline = baseline_;
  if (baseline) {
    check_comparable(*baseline, run, allowed_);
    check_same_chip(*baseline, run, allowed_);
    name_stages_like(run, *baseline);
    name_stages_like(*baseline, run);
  }
  CheckResult result = check_budget(run, budget_, baseline ? &*baseline : nullptr);
  result.is_kept = is_kept_;
  return result;
}

std::optional<Gate> optional_gate(const GateOptions& options, const RecordOptions& chip) {
  if (!options.budget.empty()) return Gate(options, chip);
  if (!options.baseline.empty())
    throw InputError("--baseline is for a budget; expected --budget as well");
  return std::nullopt;
}

void print_check(const CheckResult& result) {
  print(check_printout(result, {}));
  if (result.missed() > 0) throw LimitNotMet();
}

}  // namespace leviosim::tools
