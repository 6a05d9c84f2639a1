#include "tools/app/study/whatif/whatif.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numeric>
#include <optional>

#include "platform_models/loader/instruction_set.h"
#include "platform_models/loader/parameter.h"
#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/energy/area.h"
#include "sim/work/arena.h"
#include "sim/work/offload_regions.h"
#include "tools/app/cli/host.h"
#include "tools/app/record/statistics.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/simulate.h"
#include "traces/work_traces/work_frames.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {
namespace {

constexpr const char* kAsItIs = "as it is";

struct SettingChoice {
  std::string path;
  std::vector<std::string> values;
};

/// "32,64KiB": 32 has the unit of the last, too.
void share_unit(std::vector<std::string>& values) {
  const std::optional<platform::Measure> last = platform::split_measure(values.back());
  if (!last || last->unit.empty()) return;
  for (std::string& value : values)
    if (const auto measure = platform::split_measure(value); measure && measure->unit.empty())
      value += last->unit;
}

/// "a=1,2,b=3": a is 1 or 2, b is 3.
std::vector<SettingChoice> choices_of(const std::string& text) {
  std::vector<SettingChoice> choices;
  for (const std::string& item : base::split(text, ',')) {
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos)
      choices.back().values.push_back(item);
    else
      choices.push_back({item.substr(0, equals), {item.substr(equals + 1)}});
  }
  for (SettingChoice& choice : choices) share_unit(choice.values);
  return choices;
}

void take_costs(VariantResult& result, const RunResult& run) {
  if (const std::optional<RunEnergy> energy = energy_of(run))
    if (const auto frame = energy->per_frame())
      result.energy_mj = {frame->value.count() * 1e3, frame->low().count() * 1e3,
                          frame->high().count() * 1e3};
  if (!sim::knows_area(run.chip)) return;
  const sim::AreaItem chip = sim::total_area(run.chip);
  result.area_mm2 = chip.area.count() * 1e-6;
  result.is_whole_area = chip.known;
}

VariantResult timed(const Variant& variant, const ResolvedPoint& point, KnownRuns& known) {
  RunRequest request = point.request;
  request.time_bands = TimeBandsOf::slowest_frame;
  request.on_one_core = false;
  const auto progress = [](const Progress&) { throw_if_interrupted(); };
  const RunResult run = point.trace != nullptr ? known.replay(*point.trace, request, progress).run
                                               : simulate(request, progress);
  VariantResult result;
  result.name = variant.name;
  result.raised = variant.raised;
  result.is_run = point.trace == nullptr;
  result.frames = run.frames.size();
  result.period_ms = static_cast<double>(run.frame_period_ns) * 1e-6;
  if (const std::optional<FrameTimes> times = frame_times(run)) result.times = *times;
  const RunFigures figures = figures_of(run);
  result.verdicts = figures.verdicts;
  result.unused = unused_accelerators(figures);
  take_costs(result, run);
  for (const StageResult& stage : run.stages)
    if (stage.transfers.tiles > 0) result.tiled.push_back(stage.name);
  result.parts = {cycle_parts(run), request.cores, static_cast<double>(run.frames.size()),
                  run.cluster_clock};
  return result;
}

/// Sections that are no resources of the chip.
constexpr std::array<std::string_view, 4> kNotHardware{"energy.", "area.", "supply.", "isa."};
/// Shapes of caches and bursts: no amounts.
constexpr std::array<std::string_view, 5> kShapes{".line", ".ways", ".burst", ".max_workers",
                                                  ".workers"};

bool is_resource(const platform::Schema& schema, const platform::Parameter& parameter) {
  const std::string_view path = parameter.path;
  for (const std::string_view section : kNotHardware)
    if (path.starts_with(section)) return false;
  for (const std::string_view shape : kShapes)
    if (path.ends_with(shape)) return false;
  const platform::Dimension* dimension = schema.fields()[schema.find(path)].dimension;
  return dimension == &platform::kSize || dimension == &platform::kBanks ||
         dimension == &platform::kUnits || dimension == &platform::kRate;
}

/// "cluster.l1.banks=32", "cluster.l1.size=256KiB": a count goes without its unit.
Variant changed(const platform::Schema& schema, const platform::Parameter& parameter,
                double factor) {
  const platform::Dimension& dimension = *schema.fields()[schema.find(parameter.path)].dimension;
  const double value = *platform::parse_number(parameter.value) * factor;
  const std::string text =
      platform::number_text(value) + (dimension.units.size() > 1 ? parameter.unit : "");
  return {fmt::format("{}={}", parameter.path, text),
          {{std::string(kChipSettings) + parameter.path, text}}};
}

/// Whole numbers stay whole, and nothing vanishes.
bool may_be(const platform::Schema& schema, const platform::Parameter& parameter, double factor) {
  const platform::Field& field = schema.fields()[schema.find(parameter.path)];
  const double value = *platform::parse_number(parameter.value) * factor;
  const double unit = field.dimension->find(parameter.unit)->factor;
  const bool whole =
      field.dimension == &platform::kRate || value * unit == std::floor(value * unit);
  return value > 0 && whole;
}

const platform::Parameter* find(const platform::ResolvedPlatform& chip, std::string_view path) {
  const auto it = std::find_if(chip.parameters.begin(), chip.parameters.end(),
                               [&](const platform::Parameter& p) { return p.path == path; });
  return it == chip.parameters.end() ? nullptr : &*it;
}

/// Accelerators that a built-in platform has on top of this chip.
std::optional<Variant> with_accelerators_of(const std::string& name,
                                            const platform::ResolvedPlatform& chip) {
  Variant variant{name + "'s units", {}};
  const platform::ResolvedPlatform other = platform::resolve_platform(name);
  for (const platform::Parameter& parameter : other.parameters) {
    if (find(chip, parameter.path) != nullptr) continue;
    if (parameter.path.find(".accelerators.") == std::string::npos) return std::nullopt;
    variant.settings[std::string(kChipSettings) + parameter.path] =
        parameter.value + parameter.unit;
  }
  if (variant.settings.empty() || other.parameters.size() < chip.parameters.size())
    return std::nullopt;
  return variant;
}

constexpr const char* kWorkers = "platform.cluster.workers";
constexpr const char* kEventUnit = "platform.cluster.max_workers";
constexpr const char* kL1Size = "platform.cluster.l1.size";
constexpr const char* kBase = "platform.isa.base";
constexpr std::string_view kCodePath = "isa.code";

/// Whether its work may have to be computed, which takes ten times as long as to time what was.
bool may_be_run(const Variant& variant) {
  const SweepRow& settings = variant.settings;
  return settings.count(kWorkers) + settings.count(kL1Size) + settings.count("platform") > 0;
}

void raise(Variant& variant, const char* key, const std::string& value) {
  variant.settings[key] = value;
  variant.raised.push_back(
      fmt::format("{}={}", std::string_view(key).substr(kChipSettings.size()), value));
}

}  // namespace

std::string VariantResult::verdict() const {
  std::vector<std::string> faults;
  for (const RunVerdict& verdict : verdicts.list) {
    const bool is_time = verdict.about == "time";
    const bool is_late = is_time && verdict.grade == Grade::doubtful;
    const Banded& decides = verdict.grade == Grade::bad ? times.mean_ns : times.worst_ns;
    const bool is_open = is_time && times.has_bands && decides.holds(period_ms * 1e6);
    if (verdict.grade == Grade::good && !is_open) continue;
    std::string words = is_late   ? fmt::format("{} late", times.late)
                        : is_time ? std::string(verdict.word())
                                  : fmt::format("{} {}", verdict.about, verdict.word());
    faults.push_back(words + (is_open ? "?" : ""));
  }
  return faults.empty() ? "fits" : fmt::format("{}", fmt::join(faults, ", "));
}

WhatIf::WhatIf(SweepInputs& inputs, std::string trace, SweepRow again)
    : inputs_(inputs), trace_(std::move(trace)), again_(std::move(again)) {
  plan_.file = "whatif";
  plan_.reference = &inputs_.trace(trace_, {trace_}).platform;
}

void WhatIf::expect_known(const std::string& change, const SweepRow& settings) {
  const platform::Schema& schema = plan_.reference->schema();
  for (const auto& [name, value] : settings) {
    if (name == "platform") {
      inputs_.platform(value, {change});
      continue;
    }
    const std::string path = name.substr(kChipSettings.size());  // as it was typed
    if (path.starts_with("workload."))
      throw InputError(fmt::format(
          "{}: changes what is computed, not the chip; expected a key of the chip (leviosim run -p "
          "{} computes it, leviosim compare sets both beside each other)",
          change, change));
    if (path == "technology")
      throw InputError(
          fmt::format("{}: scaling between technologies is not modelled; expected numbers of "
                      "another chip, such as area.…, energy.… and supply.…",
                      change));
    if (path == kCodePath && settings.count(kBase) == 0)
      throw InputError(fmt::format(
          "{}: says how the workload was compiled, which is nothing of the chip alone; expected "
          "isa.base={}, the instruction set with its costs and its code",
          change, value));
    if (schema.find(path) == platform::Schema::kNone && path != platform::kBasePath)
      throw InputError(
          fmt::format("{}: unknown key{}", change, base::did_you_mean(path, schema.paths())));
    if (value.empty())
      throw InputError(fmt::format("{}: {} is empty; expected a value", change, path));
    const std::optional<platform::Measure> measure = platform::split_measure(value);
    if (measure && !std::isfinite(measure->number))
      throw InputError(fmt::format("{}: '{}' is not a finite number", change, value));
  }
}

std::vector<Variant> WhatIf::variants(const std::string& change) {
  const std::size_t equals = change.find('=');
  const std::size_t colon = equals == std::string::npos ? equals : change.rfind(':', equals);
  SweepRow chip;
  std::string prefix;
  std::string changes = change;
  if (equals == std::string::npos || colon != std::string::npos) {
    prefix = change.substr(0, colon);
    chip["platform"] = prefix;
    changes = colon == std::string::npos ? "" : change.substr(colon + 1);
    if (!changes.empty()) prefix += ':';
  }
  std::vector<Variant> all{{prefix, chip}};
  if (!changes.empty())
    for (const SettingChoice& choice : choices_of(changes)) {
      const std::vector<Variant> before = std::exchange(all, {});
      for (const Variant& variant : before)
        for (const std::string& value : choice.values) {
          Variant next = variant;
          const bool first = next.settings.size() == chip.size();
          next.name += fmt::format("{}{}={}", first ? "" : ",", choice.path, value);
          next.settings[std::string(kChipSettings) + choice.path] = value;
          all.push_back(std::move(next));
        }
    }
  for (Variant& variant : all) {
    expect_known(change, variant.settings);
    name_chip(variant);
    raise_event_unit(variant);
  }
  return all;
}

void WhatIf::name_chip(Variant& variant) {
  if (variant.settings.count(kBase) == 0 || variant.settings.count("platform") > 0) return;
  const std::string chip = shipped_chip(*inputs_.trace(trace_, {trace_}).work);
  if (!chip.empty()) variant.settings["platform"] = chip;
}

void WhatIf::raise_event_unit(Variant& variant) {
  const auto workers = variant.settings.find(kWorkers);
  if (workers == variant.settings.end() || variant.settings.count(kEventUnit) > 0) return;
  const auto chip = variant.settings.find("platform");
  platform::PlatformFile& file = chip == variant.settings.end()
                                     ? *plan_.reference
                                     : inputs_.platform(chip->second, {variant.name});
  const std::optional<double> number = platform::parse_number(workers->second);
  if (number && *number > file.resolve({}).config.cluster.max_workers)
    raise(variant, kEventUnit, workers->second);
}

bool WhatIf::has_other_l1(const SweepRow& settings, const sim::ChipConfig& chip) {
  if (settings.count("platform") == 0 && settings.count(kL1Size) == 0) return false;
  if (!recorded_l1_) recorded_l1_ = plan_.reference->resolve({}).config.cluster.l1.size;
  return chip.cluster.l1.size != *recorded_l1_;
}

bool WhatIf::passes_in_tiles() {
  if (passes_in_tiles_) return *passes_in_tiles_;
  traces::WorkFrames reader(*inputs_.trace(trace_, {trace_}).work);
  traces::WorkFrame frame;
  const auto waits = [](const work::StageRun& stage) {
    return std::any_of(stage.steps.begin(), stage.steps.end(), [](const work::Step& step) {
      return std::holds_alternative<work::TransferWait>(step);
    });
  };
  bool found = false;
  while (!found && reader.next(frame))
    found = std::any_of(frame.front_end.stages.begin(), frame.front_end.stages.end(), waits);
  passes_in_tiles_ = found;
  return found;
}

ResolvedPoint WhatIf::resolved(const Variant& variant, bool anew) {
  const std::lock_guard<std::mutex> lock(resolving_);
  SweepRow settings = variant.settings;
  settings["trace"] = trace_;
  const traces::WorkTrace& trace = *inputs_.trace(trace_, {trace_}).work;
  const std::string where = variant.name;
  platform::PlatformFile& chip = settings.count("platform") > 0
                                     ? inputs_.platform(settings["platform"], {where})
                                     : inputs_.trace(trace_, {where}).platform;
  std::vector<std::string> overrides;
  for (const auto& [name, value] : settings)
    if (name.starts_with(kChipSettings))
      overrides.push_back(name.substr(kChipSettings.size()) + '=' + value);
  const platform::ResolvedPlatform platform = chip.resolve(overrides);
  const int workers = platform.config.cluster.workers;
  anew = anew || (!again_.empty() && has_other_l1(settings, platform.config) && passes_in_tiles());
  if (!anew && (workers == trace.info().cores ||
                (variant.settings.empty() && workers >= trace.info().cores))) {
    settings["cores"] = fmt::format("{}", trace.info().cores);
    return resolve(plan_, settings, inputs_, where);
  }
  if (again_.empty())
    throw InputError(
        fmt::format("its work was divided among {} cores, and how it is among {} is not in the "
                    "trace; expected the folder of a run, whose data are there",
                    trace.info().cores, workers));
  SweepRow run = again_;
  run.insert(settings.begin(), settings.end());
  run.erase("trace");
  if (run.count("platform") == 0) {  // the recorded chip has no name that could be looked up
    ResolvedPoint point;
    run["platform"] = "gap9";
    SweepRow plain = run;
    std::erase_if(plain, [](const auto& item) { return item.first.starts_with(kChipSettings); });
    point = resolve(plan_, plain, inputs_, where);
    point.chip = &chip;
    point.overrides = overrides;
    point.request.platform = platform;
    point.request.cores = workers;
    return point;
  }
  return resolve(plan_, run, inputs_, where);
}

std::vector<VariantResult> WhatIf::results(const std::vector<Variant>& variants,
                                           const RunnerOptions& options) {
  std::vector<Variant> all{{kAsItIs, {}}};
  all.insert(all.end(), variants.begin(), variants.end());
  std::vector<VariantResult> results(all.size());
  const auto result_of = [&](const Variant& variant) {
    try {
      return timed(variant, resolved(variant), known_);
    } catch (const work::MemoryOverflow& full) {
      if (full.memory() == "L2" || again_.empty()) throw;
      // Recorded work that does not fit passes in tiles where it is computed on this chip.
      return timed(variant, resolved(variant, true), known_);
    }
  };
  // What takes long begins first, so that all threads end at about the same time.
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_partition(order.begin() + 1, order.end(),
                        [&](std::size_t i) { return may_be_run(all[i]); });
  run_all(all.size(), options, [&](std::size_t at) {
    const std::size_t i = order[at];
    throw_if_interrupted();
    try {
      results[i] = result_of(all[i]);
    } catch (const InputError& error) {
      if (i == 0) throw;
      results[i].name = all[i].name;
      results[i].raised = all[i].raised;
      results[i].failure = error.what();
    }
  });
  return results;
}

std::vector<Variant> WhatIf::standard_variants() {
  const platform::ResolvedPlatform chip = plan_.reference->resolve({});
  const platform::Schema& schema = plan_.reference->schema();
  std::vector<Variant> all;
  for (const platform::Parameter& parameter : chip.parameters)
    if (is_resource(schema, parameter))
      for (const double factor : {0.5, 2.0})
        if (may_be(schema, parameter, factor)) all.push_back(changed(schema, parameter, factor));
  const platform::Parameter* cluster = find(chip, "cluster.clock");
  const platform::Parameter* controller = find(chip, "controller.clock");
  for (const double factor : {0.5, 2.0}) {
    const Variant slow = changed(schema, *cluster, factor);
    const Variant both = changed(schema, *controller, factor);
    Variant variant{slow.name + ',' + both.name, slow.settings};
    variant.settings.insert(both.settings.begin(), both.settings.end());
    all.push_back(std::move(variant));
  }
  const sim::ClusterConfig& team = chip.config.cluster;
  if (!again_.empty() && team.workers > 1)
    for (const int workers : {team.workers / 2, team.workers * 2})
      all.push_back(
          {fmt::format("cluster.workers={}", workers), {{kWorkers, fmt::format("{}", workers)}}});
  for (const std::string& name : platform::platform_names())
    if (auto variant = with_accelerators_of(name, chip)) all.push_back(*std::move(variant));
  for (Variant& variant : all) raise_event_unit(variant);
  return all;
}

}  // namespace leviosim::tools
