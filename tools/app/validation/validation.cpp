#include "tools/app/validation/validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "tools/app/table/json.h"
#include "tools/app/validation/distributions.h"
#include "tools/app/validation/paper_stages.h"
#include "tools/app/validation/published_files.h"
#include "tools/app/validation/quantities.h"
#include "tools/app/validation/run_inputs.h"
#include "workload/vio/profile.h"
#include "workload/vio/stages.h"

namespace leviosim::tools {
namespace {

using Value = std::optional<double>;

constexpr std::string_view kError = "error.";

bool is_summary(const Reference& reference) {
  return std::string_view(reference.name).substr(0, kError.size()) == kError;
}

bool is_in_group(const std::string& name, std::string_view group) {
  return name.rfind("compute.", 0) == 0 && name.size() > group.size() &&
         std::string_view(name).substr(name.size() - group.size() - 1) == fmt::format(".{}", group);
}

/// "error.multi.worst" from the errors of all compute.*.multi; nothing if one of them is missing.
Value summary(const std::string& name, const std::vector<Comparison>& before) {
  const std::size_t dot = name.rfind('.');
  const std::string what = name.substr(dot + 1);
  const std::string group = name.substr(kError.size(), dot - kError.size());
  double sum = 0;
  double worst = 0;
  int n = 0;
  for (const Comparison& comparison : before) {
    if (!is_in_group(comparison.reference.name, group)) continue;
    if (!comparison.value) return std::nullopt;
    const double error = std::abs(*comparison.error());
    sum += error;
    worst = std::max(worst, error);
    ++n;
  }
  if (n == 0 || (what != "mean" && what != "worst"))
    throw InputError(fmt::format(
        "reference '{}': expected error.GROUP.mean or .worst after rows compute.*.GROUP", name));
  return what == "mean" ? sum / n : worst;
}

Value find(const std::vector<Quantity>& quantities, const Reference& reference) {
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities) {
    names.push_back(quantity.name);
    if (quantity.name != reference.name) continue;
    if (quantity.unit != reference.unit)
      throw InputError(fmt::format("reference '{}': unit '{}'; expected '{}'", reference.name,
                                   reference.unit, quantity.unit));
    return quantity.value;
  }
  throw InputError(fmt::format("reference '{}': a run has no such quantity{}", reference.name,
                               base::did_you_mean(reference.name, names)));
}

std::string cell(Value value) { return value ? fmt::format("{:.6g}", *value) : std::string(); }
std::string deviation_text(const Reference& reference, double value) {
  return fmt::format("{:.6g}{}", value, reference.tolerance.relative ? " %" : "");
}

std::string comparison_line(std::string_view kind, const Comparison& c) {
  const Reference& r = c.reference;
  return fmt::format(
      "{},{},{},{}{:.6g},{},{},{},{},{},{},{}\n", kind, r.name, r.unit, r.limit ? "<" : "", r.value,
      cell(c.value), c.value ? deviation_text(r, *c.error()) : "",
      deviation_text(r, r.tolerance.value), r.guard ? deviation_text(r, *r.guard) : "",
      name_of(c.verdict), r.reason, r.source);
}

Json comparison_json(const Comparison& c) {
  const Reference& r = c.reference;
  Json entry;
  entry["name"] = r.name;
  entry["unit"] = r.unit;
  entry["reference"] = r.value;
  entry["is_limit"] = r.limit;
  entry["value"] = value_of(c.value);
  entry["error"] = value_of(c.error());
  entry["error_unit"] = r.tolerance.relative ? "%" : r.unit;
  entry["tolerance"] = r.tolerance.value;
  entry["guard"] = value_of(r.guard);
  entry["verdict"] = name_of(c.verdict);
  entry["reason"] = r.reason;
  entry["source"] = r.source;
  return entry;
}

std::string path_lines(const StageOnPaths& stage, std::string_view cores,
                       const StageOnPaths::Means& means) {
  std::string text;
  for (const auto& [frames, mean] :
       {std::pair("EPnP", means.epnp), std::pair("8-point", means.eight_point),
        std::pair("as the paper's", means.weighed)})
    text +=
        fmt::format("path,{}: {}: {},cycles,,{},,,,,,\n", stage.title, cores, frames, cell(mean));
  return text;
}

std::string band_lines(std::string_view kind, const std::vector<BandedStage>& bands) {
  std::string text;
  for (const BandedStage& band : bands)
    for (const auto& [end, value] : {std::pair("low", band.weighed.value_or(band.simulated).low),
                                     std::pair("high", band.weighed.value_or(band.simulated).high)})
      text += fmt::format("{},{}: {}: {},kcycles,{},{},,,,,,\n", kind, band.title,
                          band.single ? "one core" : "N cores", end, cell(band.paper), cell(value));
  return text;
}

Json bands_json(const std::vector<BandedStage>& bands) {
  Json list = Json::array();
  for (const BandedStage& band : bands) {
    const Banded& shown = band.weighed.value_or(band.simulated);
    list.push_back({{"stage", band.title},
                    {"cores", band.single ? "one" : "N"},
                    {"paper", band.paper},
                    {"simulated", shown.value},
                    {"low", shown.low},
                    {"high", shown.high},
                    {"inside", band.is_inside()}});
  }
  return list;
}

/// Guards and what is said of misses are of the default's number of keypoints.
Comparison without_guard(Comparison c) {
  c.reference.guard.reset();
  c.reference.reason.clear();
  c.reference.met = true;
  c.verdict = judge(c.reference, c.value);
  return c;
}

bool is_of_paper_table(const std::string& name) {
  for (const PaperStage& stage : kPaperStages)
    if (name.starts_with(fmt::format("compute.{}.", stage.key))) return true;
  return false;
}

Json means_json(const StageOnPaths::Means& means) {
  return {{"epnp", value_of(means.epnp)},
          {"eight_point", value_of(means.eight_point)},
          {"as_in_the_paper", value_of(means.weighed)}};
}

Json normalised_json(const NormalisedFigure& n) {
  Json entry;
  entry["stage"] = n.stage;
  entry["unit"] = n.unit;
  entry["units_per_call"] = value_of(n.units);
  entry["cycles_single"] = value_of(n.single);
  entry["cycles_parallel"] = value_of(n.parallel);
  entry["paper_units_per_call"] = value_of(n.paper_units);
  entry["paper_cycles_single"] = value_of(n.paper_single);
  entry["units_that_explain_the_paper"] = value_of(n.explaining_units);
  return entry;
}

/// Of a stage of the paper's table on one core or on N; absent if the run has no such band.
std::optional<BandedStage> banded_stage(const RunResult& run, const Validation& validation,
                                        const PaperStage& stage, bool single) {
  const std::string name = fmt::format("compute.{}.{}", stage.key, single ? "single" : "multi");
  const Comparison* compared = nullptr;
  for (const Comparison& c : validation.comparisons)
    if (c.reference.name == name) compared = &c;
  if (compared == nullptr || !compared->value) return std::nullopt;
  for (const TimeBands::Stage& bands : run.time_bands->stages) {
    if (bands.stage != stage.stage) continue;
    const Banded& relative = single ? bands.single : bands.parallel;
    BandedStage result{stage.title, single, compared->reference.value, *compared->value * relative};
    for (const StageOnPaths& paths : validation.paths)
      if (const auto mean = (single ? paths.single : paths.parallel).weighed;
          mean && paths.key == stage.key)
        result.weighed = *mean * 1e-3 * relative;
    return result;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Comparison> compare(const std::vector<Reference>& references,
                                const std::vector<Quantity>& quantities) {
  std::vector<Comparison> comparisons;
  for (const Reference& reference : references) {
    Comparison comparison{reference, {}, Verdict::NotCovered};
    comparison.value =
        is_summary(reference) ? summary(reference.name, comparisons) : find(quantities, reference);
    comparison.verdict = judge(reference, comparison.value);
    comparisons.push_back(std::move(comparison));
  }
  return comparisons;
}

Validation validate(const RunResult& run, const FrameLog& log, const vio::Profile& profile,
                    const std::vector<Reference>& references) {
  Validation validation{
      compare(references, quantities_of(run, log)), inputs_of(run, log, profile),
      profile.name == "levio" ? input_distributions(log) : std::vector<InputDistribution>{},
      normalised(run, log, profile), stages_on_paths(log)};
  if (run.time_bands)
    for (const bool single : {true, false})
      for (const PaperStage& stage : kPaperStages)
        if (const auto band = banded_stage(run, validation, stage, single))
          validation.bands.push_back(*band);
  return validation;
}

WithPaperKeypoints part_with_paper_keypoints(const Validation& second) {
  WithPaperKeypoints part;
  for (const InputDistribution& input : second.distributions)
    if (input.quantity == kInputs.front().quantity) part.keypoints = input.simulated.front();
  for (const Comparison& c : second.comparisons)
    if (is_summary(c.reference) || is_of_paper_table(c.reference.name))
      part.comparisons.push_back(c);
  part.bands = second.bands;
  return part;
}

std::string validation_csv(const Validation& validation) {
  std::string text = "kind,name,unit,paper,simulated,error,tolerance,guard,verdict,reason,source\n";
  for (const Comparison& c : validation.comparisons) text += comparison_line("reference", c);
  for (const InputFigure& input : validation.inputs)
    text += fmt::format("input,{},{},{},{},,,,,,{}\n", input.key, input.unit, cell(input.paper),
                        cell(input.value), input.source);
  for (const InputDistribution& d : validation.distributions)
    for (std::size_t i = 0; i < kDistributionColumns.size(); ++i)
      if (d.simulated[i])
        text += fmt::format("distribution,{}: {},,{},{},,,,,,\n", d.quantity,
                            kDistributionColumns[i], cell(d.released[i]), cell(d.simulated[i]));
  for (const NormalisedFigure& n : validation.normalised) {
    text += fmt::format("normalised,{}: one core,cycles per {},{},{},,,,,,\n", n.stage, n.unit,
                        cell(n.paper_per_unit()), cell(n.single));
    text += fmt::format("normalised,{}: N cores,cycles per {},,{},,,,,,\n", n.stage, n.unit,
                        cell(n.parallel));
  }
  for (const StageOnPaths& stage : validation.paths)
    text +=
        path_lines(stage, "one core", stage.single) + path_lines(stage, "N cores", stage.parallel);
  text += band_lines("band", validation.bands);
  if (const auto& part = validation.with_paper_keypoints) {
    constexpr std::string_view kKind = "paper's keypoints";
    for (const Comparison& c : part->comparisons) text += comparison_line(kKind, without_guard(c));
    text += band_lines(kKind, part->bands);
  }
  return text;
}

Json validation_json(const Validation& validation) {
  Json document;
  document["format"] = "leviosim validation";
  document["version"] = 1;
  document["comparisons"] = Json::array();
  for (const Comparison& comparison : validation.comparisons)
    document["comparisons"].push_back(comparison_json(comparison));
  document["inputs"] = Json::array();
  for (const InputFigure& input : validation.inputs) {
    Json entry;
    entry["name"] = input.key;
    entry["description"] = input.name;
    entry["unit"] = input.unit;
    entry["value"] = value_of(input.value);
    entry["paper"] = value_of(input.paper);
    entry["source"] = input.source;
    document["inputs"].push_back(std::move(entry));
  }
  document["distributions"] = Json::array();
  for (const InputDistribution& d : validation.distributions) {
    Json entry;
    entry["quantity"] = d.quantity;
    for (std::size_t i = 0; i < kDistributionColumns.size(); ++i)
      entry[std::string(kDistributionColumns[i])] = {{"release", value_of(d.released[i])},
                                                     {"value", value_of(d.simulated[i])}};
    document["distributions"].push_back(std::move(entry));
  }
  document["normalised"] = Json::array();
  for (const NormalisedFigure& figure : validation.normalised)
    document["normalised"].push_back(normalised_json(figure));
  document["paths"] = Json::array();
  for (const StageOnPaths& stage : validation.paths)
    document["paths"].push_back({{"stage", stage.title},
                                 {"cycles_single", means_json(stage.single)},
                                 {"cycles_parallel", means_json(stage.parallel)}});
  document["bands"] = bands_json(validation.bands);
  if (const auto& part = validation.with_paper_keypoints) {
    Json& entry = document["with_paper_keypoints"];
    entry["keypoints"] = value_of(part->keypoints);
    entry["comparisons"] = Json::array();
    for (const Comparison& c : part->comparisons)
      entry["comparisons"].push_back(comparison_json(without_guard(c)));
    entry["bands"] = bands_json(part->bands);
  }
  return document;
}

}  // namespace leviosim::tools
