#include "tools/app/html_report/run_data.h"

#include "sim/base/error.h"
#include "tools/app/html_report/key_figures.h"
#include "tools/app/html_report/page.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

/// Stamps since the first, in seconds: those of data sets are too large for numbers of scripts.
void use_seconds(Json& table) {
  if (!table.contains("t_ns")) return;
  Json seconds = Json::array();
  const Json& stamps = table.at("t_ns");
  for (const Json& stamp : stamps)
    seconds.push_back(
        static_cast<double>(stamp.get<std::int64_t>() - stamps.front().get<std::int64_t>()) * 1e-9);
  table.erase("t_ns");
  table["t_s"] = std::move(seconds);
}

/// As columns; null if the run has none of that name.
Json table_of(const RunFolder& run, const char* name) {
  const auto found = run.tables.find(name);
  if (found == run.tables.end()) return nullptr;
  const std::string where = run.record.name + '/' + name;
  Json table = columns_json(found->second,
                            [](const std::string& column) { return !column.ends_with("_ops"); });
  try {
    use_seconds(table);
  } catch (const nlohmann::json::exception&) {
    throw InputError(where + ": a time stamp is no whole number");
  }
  return table;
}

/// The processed frame with the longest latency, if the table knows latencies.
/// @param stages  of stages_of()
std::optional<WorstFrame> worst_frame(const RunRecord& record, const Json& frames,
                                      const Json& stages) {
  if (!frames.contains("latency_ns")) return std::nullopt;
  const Json& latencies = frames.at("latency_ns");
  std::optional<std::size_t> at;
  for (std::size_t i = 0; i < latencies.size(); ++i)
    if (latencies[i].is_number() && (!at || latencies[i] > latencies[*at])) at = i;
  if (!at) return std::nullopt;
  WorstFrame worst;
  worst.frame = frames.at("frame")[*at].get<int>();
  worst.latency_ns = latencies[*at].get<double>();
  worst.waited_ns =
      frames.at("start_ns")[*at].get<double>() - frames.at("arrival_ns")[*at].get<double>();
  const double clock = record.value("run.cluster_clock").value_or(0);
  for (const Json& stage : stages) {
    const std::string column = kStageColumn + stage.at("key").get<std::string>();
    if (!frames.contains(column) || !frames.at(column)[*at].is_number()) continue;
    const double ns = frames.at(column)[*at].get<double>() / clock * 1e9;
    if (ns <= worst.stage_ns) continue;
    worst.stage = stage.at("name").get<std::string>();
    worst.stage_ns = ns;
  }
  return worst;
}

Json facts_of(const RunRecord& record, const Json& manifest) {
  Json facts = facts_json(record.facts);
  facts["program"] = record.facts.program;
  try {
    facts["data"] = manifest.at("data").at("folder");
    facts["command_line"] = manifest.at("command_line");
  } catch (const Json::exception&) {
    throw InputError(record.name + "/manifest.json: is no manifest as leviosim writes it");
  }
  for (const auto& [key, name] : {std::pair{"cluster_clock", "run.cluster_clock"},
                                  {"controller_clock", "run.controller_clock"},
                                  {"voltage", "run.voltage"},
                                  {"l1_size", "run.l1_size"},
                                  {"l2_size", "run.l2_size"}})
    facts[key] = value_of(record.value(name));
  facts["deadline_ns"] = deadline_ns(record);
  return facts;
}

/// By the names that the table of stages has; without it, as the record has them.
Json stages_of(const RunRecord& record, const Json& table) {
  Json list = Json::array();
  const auto add = [&](const Json& name, const Json& key, bool on_controller) {
    list.push_back({{"name", name}, {"key", key}, {"on_controller", on_controller}});
  };
  if (table.is_null())
    for (const StageName& s : record.stages) add(s.name, s.key, s.on_controller);
  else
    for (std::size_t i = 0; i < table.at("stage").size(); ++i) {
      const Json& name = table.at("stage")[i];
      add(name, key_of(name.get<std::string>()), table.at("runs_on")[i] == "controller");
    }
  return list;
}

/// How frames get their poses, in the words of people.
Json pose_sources_json() {
  Json list = Json::array();
  for (const vio::PoseSourceInfo& info : vio::kPoseSources)
    list.push_back({{"name", info.name}, {"words", info.words}});
  return list;
}

/// Of maps that are not good, by number, and why, by bit.
Json health_json() {
  Json names = Json::array();
  for (const std::string_view name : vio::kHealthNames) names.push_back(name);
  Json reasons = Json::array();
  for (const std::string_view words : vio::kHealthReasons) reasons.push_back(words);
  return {{"names", names}, {"reasons", reasons}};
}

Json key_figures_json(const RunRecord& record, const std::string& protocol) {
  Json list = Json::array();
  for (const KeyFigure& figure : key_figures(record, protocol))
    list.push_back({{"title", figure.title},
                    {"value", figure.value},
                    {"unit", figure.unit},
                    {"note", figure.note},
                    {"share", value_of(figure.share)}});
  return list;
}

Json verdict_json(const Verdicts& verdicts) {
  Json list = Json::array();
  for (const RunVerdict& v : verdicts.list)
    list.push_back({{"about", v.about},
                    {"grade", name_of(v.grade)},
                    {"word", v.word()},
                    {"reason", v.reason()}});
  return {{"grade", verdicts.list.empty() ? Json(nullptr) : Json(name_of(verdicts.grade()))},
          {"text", verdicts.text()},
          {"list", std::move(list)}};
}

/// A table of columns that a script can rely on. @throws InputError for one that is missing
void expect_columns(const std::string& where, const Json& table,
                    std::initializer_list<const char*> columns) {
  for (const char* column : columns)
    if (!table.is_null() && !table.contains(column))
      throw InputError(where + ": has no column " + column);
}

Json tables_of(const RunFolder& run) {
  Json tables;
  tables["frames"] = table_of(run, kFramesFile);
  tables["stages"] = table_of(run, kStagesFile);
  tables["memory"] = table_of(run, kMemoryFile);
  tables["energy"] = table_of(run, kEnergyFile);
  tables["errors"] = table_of(run, kErrorsFile);
  const auto where = [&](const char* name) { return run.record.name + '/' + name; };
  expect_columns(where(kFramesFile), tables["frames"],
                 {"frame", "source", "health", "health_reasons"});
  if (!tables["frames"].is_null() && tables["frames"].contains("latency_ns"))
    expect_columns(where(kFramesFile), tables["frames"], {"arrival_ns", "start_ns"});
  expect_columns(where(kStagesFile), tables["stages"],
                 {"stage", "call", "runs_on", "calls", "single_cycles", "parallel_cycles"});
  expect_columns(where(kMemoryFile), tables["memory"],
                 {"memory", "owner", "what", "block", "copies", "bytes"});
  expect_columns(where(kEnergyFile), tables["energy"],
                 {"stage", "quantity", "domain", "value", "unit", "low", "high"});
  expect_columns(where(kErrorsFile), tables["errors"],
                 {"t_s", "position_error_m", "estimate_x_m", "estimate_y_m", "estimate_z_m",
                  "truth_x_m", "truth_y_m", "truth_z_m"});
  return tables;
}

}  // namespace

Json run_json(const RunFolder& run) {
  const RunRecord& record = run.record;
  const Statistic* const error = record.find("accuracy.ate.rmse");
  const std::string protocol = error == nullptr ? "" : error->protocol;
  Json json;
  json["name"] = record.name;
  json["facts"] = facts_of(record, run.manifest);
  json["tables"] = tables_of(run);
  json["pose_sources"] = pose_sources_json();
  json["health"] = health_json();
  json["stages"] = stages_of(record, json["tables"]["stages"]);
  const std::optional<WorstFrame> worst =
      worst_frame(record, json["tables"]["frames"], json["stages"]);
  json["verdict"] = verdict_json(record.verdicts);
  json["verdict"]["why"] = worst ? reason_of(*worst) : "";
  json["figures"] = key_figures_json(record, protocol);
  json["protocol"] = protocol;
  return json;
}

}  // namespace leviosim::tools
