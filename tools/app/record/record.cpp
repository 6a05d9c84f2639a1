#include "tools/app/record/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "sim/base/error.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/result/verdict.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFormat = "leviosim run";
constexpr int kVersion = 1;
constexpr std::size_t kMostStages = 1000;
constexpr double kLeastStageShare = 0.01;

/// Parts of names of statistics that points of studies leave to run folders: a thousand figures
/// that add up to others.
constexpr std::array kDetails{".ops.", ".code.", ".breakdown.", ".block.", ".domain."};

/// Of a stage, besides the statistics that budgets have phrases for.
constexpr std::array kKeptOfStages{"stages.{}.calls",
                                   "stages.{}.operations",
                                   "stages.{}.cycles.single.mean",
                                   "stages.{}.cycles.parallel.mean",
                                   "stages.{}.memory.parallel",
                                   "stages.{}.tiles",
                                   "stages.{}.tile_bytes",
                                   "stages.{}.tile_bytes_more",
                                   "energy.{}.call"};

bool is_detail(const std::string& name) {
  return std::any_of(kDetails.begin(), kDetails.end(),
                     [&](const char* part) { return name.find(part) != std::string::npos; });
}

std::set<std::string> kept_names(const RunRecord& run) {
  std::set<std::string> names{"frames.count", "run.frame_period", "run.cluster_clock",
                              "energy.total"};
  for (const FigureRow& row : figure_rows())
    if (!row.phrase.empty()) names.emplace(row.statistic);
  for (const StageName& stage : run.stages)
    for (const char* statistic : kKeptOfStages)
      names.insert(fmt::format(fmt::runtime(statistic), stage.key));
  const StageName* fullest = fullest_stage(run);
  const std::string blocks =
      fullest == nullptr ? "" : fmt::format("stages.{}.memory.block.", fullest->key);
  for (const Statistic& s : run.statistics) {
    if (!blocks.empty() && s.name.starts_with(blocks)) names.insert(s.name);
    if (s.name.starts_with("memory.l2.") && s.name.ends_with(".bytes")) names.insert(s.name);
    if (s.name == "memory.external.bytes") names.insert(s.name);
  }
  return names;
}

/// In whole cycles, the small parts and what rounding leaves as one.
StageParts kept_parts(const StageParts& stage) {
  StageParts kept = folded(stage, kLeastStageShare);
  std::erase_if(kept.parts, [](const CyclePart& part) { return part.mechanism == kOtherParts; });
  double listed = 0;
  for (CyclePart& part : kept.parts) {
    part.cycles = std::round(part.cycles);
    listed += part.cycles;
  }
  if (const double rest = std::round(kept.cycles - listed); rest != 0)
    kept.parts.push_back({"", std::string(kOtherParts), "", rest, 0});
  return kept;
}

/// Mechanism and kind of operation in one: "issue f32_fma".
std::string part_key(const CyclePart& part) {
  return part.operation.empty() ? part.mechanism : part.mechanism + ' ' + part.operation;
}

Json parts_json(const std::vector<CyclePart>& parts) {
  Json json = Json::object();
  for (const CyclePart& part : parts) {
    Json& place = json[part.where];
    if (place.is_null()) place = Json::object();
    const Json cycles = number_json(part.cycles);
    add_member(place, part_key(part),
               part.count == 0 ? cycles : Json::array({cycles, number_json(part.count)}));
  }
  return json;
}

/// In the order of the run, and last what is no stage's.
Json stages_json(const RunRecord& run) {
  Json list = Json::array();
  const auto add = [&](const StageName& name, const StageParts* parts) {
    Json& json = list.emplace_back(
        Json{{"name", name.name}, {"key", name.key}, {"controller", name.on_controller}});
    if (parts == nullptr) return;
    json["cycles"] = number_json(parts->cycles);
    json["parts"] = parts_json(parts->parts);
  };
  for (const StageName& stage : run.stages) add(stage, run.stage_parts(stage.name));
  for (const StageParts& parts : run.cycles)
    if (std::none_of(run.stages.begin(), run.stages.end(),
                     [&](const StageName& s) { return s.name == parts.stage; }))
      add({parts.stage, "", parts.on_controller}, &parts);
  return list;
}

Json verdicts_json(const Verdicts& verdicts) {
  Json list = Json::array();
  for (const RunVerdict& v : verdicts.list)
    list.push_back({{"about", v.about},
                    {"grade", name_of(v.grade)},
                    {"word", v.word()},
                    {"reasons", v.reasons}});
  return list;
}

/// JSON would round fractions and cut off digits.
template <class Whole>
void whole(const Json& number, Whole& value) {
  if (!number.is_number_integer()) throw std::out_of_range("no whole number");
  number.get_to(value);
  if (number != value) throw std::out_of_range("too large");
}

std::string string_of(const Json& json) { return json.get<std::string>(); }

RunFacts facts_of(const Json& json) {
  RunFacts facts;
  facts.measured = json.value("measured", false);
  json.at("profile").get_to(facts.profile);
  if (json.contains("workload")) json.at("workload").get_to(facts.workload);
  whole(json.at("seed"), facts.seed);
  json.at("platform").get_to(facts.platform);
  json.at("overrides").get_to(facts.overrides);
  whole(json.at("cores"), facts.cores);
  facts.camera = json.value("camera", "");
  whole(json.at("image").at(0), facts.image_width);
  whole(json.at("image").at(1), facts.image_height);
  whole(json.at("first_frame"), facts.first_frame);
  whole(json.at("frames"), facts.frames);
  for (const auto& [name, sha256] : json.at("inputs").items())
    facts.inputs.emplace_back(name, string_of(sha256));
  return facts;
}

Statistic statistic_of(const std::string& name, const Json& json) {
  Statistic statistic{.name = name, .unit = string_of(json.at(1))};
  if (!json.at(0).is_null()) statistic.value = json.at(0).get<double>();
  if (json.size() > 2) statistic.description = string_of(json.at(2));
  if (json.size() > 3) statistic.protocol = string_of(json.at(3));
  return statistic;
}

StageParts parts_of(const Json& json) {
  StageParts stage{string_of(json.at("name")),
                   json.at("controller").get<bool>(),
                   json.at("cycles").get<double>(),
                   {}};
  for (const auto& [where, parts] : json.at("parts").items())
    for (const auto& [key, value] : parts.items()) {
      const auto blank = key.find(' ');
      CyclePart& part = stage.parts.emplace_back(CyclePart{
          where, key.substr(0, blank), blank == std::string::npos ? "" : key.substr(blank + 1)});
      part.cycles = value.is_array() ? value.at(0).get<double>() : value.get<double>();
      if (value.is_array()) part.count = value.at(1).get<double>();
      if (describe_mechanism(part.mechanism).empty()) throw std::out_of_range("no mechanism");
    }
  return stage;
}

RunVerdict verdict_of(const Json& json) {
  const std::string about = string_of(json.at("about"));
  const std::string grade = string_of(json.at("grade"));
  for (const VerdictWord& word : verdict_words())
    if (word.about == about && name_of(word.grade) == grade)
      return {word.about, word.grade, json.at("reasons").get<std::vector<std::string>>()};
  throw std::out_of_range("no verdict");
}

RunRecord read_record_json(const Json& json, Level least) {
  RunRecord run;
  run.failure = json.value("failure", "");
  if (least != Level::figures || json.contains("facts")) {
    run.facts = facts_of(json.at("facts"));
    run.facts.program = string_of(json.at("program"));
  }
  if (least == Level::all || json.contains("verdicts"))
    for (const Json& verdict : json.at("verdicts"))
      run.verdicts.list.push_back(verdict_of(verdict));
  for (const auto& [name, statistic] : json.at("statistics").items())
    run.statistics.push_back(statistic_of(name, statistic));
  if (!json.contains("stages")) return run;  // of native runs, and of points
  if (json.at("stages").size() > kMostStages) throw std::out_of_range("too many stages");
  for (const Json& stage : json.at("stages")) {
    if (stage.contains("cycles")) run.cycles.push_back(parts_of(stage));
    if (const std::string key = string_of(stage.at("key")); !key.empty())
      run.stages.push_back({string_of(stage.at("name")), key, stage.at("controller").get<bool>()});
  }
  return run;
}

/// Of files that earlier programs wrote; empty for others.
std::string what_to_do(const std::string& format) {
  if (format == "leviosim baseline")
    return "is a baseline of an earlier leviosim; make it again: leviosim budget record RUN >FILE";
  if (format == "leviosim statistics")
    return "holds statistics of an earlier leviosim; expected run.json of a run folder";
  return {};
}

}  // namespace

const StageParts* RunRecord::stage_parts(std::string_view stage) const {
  const auto it = std::find_if(cycles.begin(), cycles.end(),
                               [&](const StageParts& s) { return s.stage == stage; });
  return it == cycles.end() ? nullptr : &*it;
}

RunRecord reduced(const RunRecord& record, Level level, const std::set<std::string>& further) {
  RunRecord result = record;
  if (level == Level::figures) {
    result.facts = {};
    result.verdicts = {};
    result.stages.clear();
    result.cycles.clear();
    std::erase_if(result.statistics, [](const Statistic& s) { return is_detail(s.name); });
  }
  if (level == Level::kept) {
    if (record.cycles.empty() && !record.facts.measured)
      throw InputError(
          fmt::format("{}: was not timed, so nobody can say why a limit is not met; expected a run "
                      "on a chip",
                      record.name));
    const std::set<std::string> names = kept_names(record);
    std::erase_if(result.statistics, [&](const Statistic& s) {
      return names.count(s.name) == 0 && further.count(s.name) == 0;
    });
    for (StageParts& stage : result.cycles) stage = kept_parts(stage);
  }
  if (level != Level::all)
    for (Statistic& statistic : result.statistics) {
      statistic.description.clear();
      statistic.protocol.clear();
    }
  return result;
}

Json facts_json(const RunFacts& facts) {
  Json json;
  if (facts.measured) json["measured"] = true;
  json["profile"] = facts.profile;
  if (!facts.workload.empty()) json["workload"] = facts.workload;
  json["seed"] = facts.seed;
  json["platform"] = facts.platform;
  json["overrides"] = facts.overrides;
  json["cores"] = facts.cores;
  if (!facts.camera.empty()) json["camera"] = facts.camera;
  json["image"] = {facts.image_width, facts.image_height};
  json["first_frame"] = facts.first_frame;
  json["frames"] = facts.frames;
  json["inputs"] = Json::object();
  for (const auto& [name, sha256] : facts.inputs) json["inputs"][name] = sha256;
  return json;
}

Json record_json(const RunRecord& record) {
  Json json = Json::object();
  if (!record.failure.empty()) json["failure"] = record.failure;
  if (!record.verdicts.list.empty()) json["verdicts"] = verdicts_json(record.verdicts);
  if (record.facts != RunFacts()) {
    json["program"] = record.facts.program;
    json["facts"] = facts_json(record.facts);
  }
  json["statistics"] = statistics_json(record.statistics);
  if (Json stages = stages_json(record); !stages.empty()) json["stages"] = std::move(stages);
  return json;
}

RunRecord record_of_json(const std::string& where, const Json& json, Level least) {
  const auto damaged = [&] {
    return InputError(fmt::format("{}: does not hold a run as leviosim writes it", where));
  };
  try {
    return read_record_json(json, least);
  } catch (const Json::exception&) {
    throw damaged();
  } catch (const std::out_of_range&) {
    throw damaged();
  }
}

std::string record_text(const RunRecord& record) {
  Json document{{"format", kFormat}, {"version", kVersion}};
  document.update(record_json(record));
  return json_lines(document) + '\n';
}

RunRecord parse_record(const std::string& where, std::string_view text, Level least) {
  const Json document = read_json(where, text);
  const Json& format = document.contains("format") ? document.at("format") : Json();
  if (format != kFormat || !document.contains("version") || document.at("version") != kVersion) {
    const std::string advice = what_to_do(format.is_string() ? string_of(format) : "");
    if (!advice.empty()) throw InputError(fmt::format("{}: {}", where, advice));
    throw InputError(fmt::format(
        "{}: is no record of a run of version {}; expected run.json of a run folder, or what "
        "'leviosim budget record' prints",
        where, kVersion));
  }
  RunRecord record = record_of_json(where, document, least);
  record.name = where;
  return record;
}

}  // namespace leviosim::tools
