#include "tools/app/comparison/comparison_files.h"

#include "sim/base/csv.h"
#include "sim/base/printable.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/comparison/main_causes.h"
#include "tools/app/comparison/model_errors.h"
#include "tools/app/record/record.h"
#include "tools/app/result/verdict.h"
#include "tools/app/table/table_files.h"

namespace leviosim::tools {
namespace {

Json quantity_json(const ComparedQuantity& q) {
  Json json;
  json["name"] = q.name;
  json["unit"] = q.unit;
  json["a"] = value_of(q.a);
  json["b"] = value_of(q.b);
  json["difference"] = value_of(q.difference());
  for (const ComparedQuantity& part : q.parts) json["parts"].push_back(quantity_json(part));
  return json;
}

Json list_json(const std::vector<ComparedQuantity>& list) {
  Json json = Json::array();
  for (const ComparedQuantity& q : list) json.push_back(quantity_json(q));
  return json;
}

Json stage_json(const StageComparison& s) {
  Json json;
  json["name"] = s.stage.name;
  json["key"] = s.stage.key;
  json["runs_on"] = s.stage.on_controller ? "controller" : "cluster";
  json["same_work"] = s.same_work;
  for (const auto& [key, quantity] : {std::pair{"calls", &s.calls},
                                      {"operations", &s.operations},
                                      {"single", &s.single},
                                      {"parallel", &s.parallel},
                                      {"share", &s.share}})
    json[key] = quantity_json(*quantity);
  if (!s.mechanisms) return json;
  json["causes"] = {
      {"work", s.causes.work}, {"cost", s.causes.cost}, {"contention", s.causes.contention}};
  json["by_mechanism"] = quantity_json(*s.mechanisms);
  json["by_fork"] = quantity_json(*s.forks);
  return json;
}

class CsvRows {
 public:
  void add(const std::string& subject, const std::string& quantity, const ComparedQuantity& q,
           const std::string& part = {}, const std::string& subpart = {}) {
    table_.add({printable(subject), printable(quantity), printable(part), printable(subpart),
                printable(q.unit), q.a, q.b, q.difference()});
    for (const ComparedQuantity& below : q.parts)
      add(subject, quantity, below, part.empty() ? below.name : part,
          part.empty() ? "" : below.name);
  }
  std::string text() const { return csv_text(table_); }

 private:
  Table table_{{{.key = "subject"},
                {.key = "quantity"},
                {.key = "part"},
                {.key = "subpart"},
                {.key = "unit"},
                {.key = "a"},
                {.key = "b"},
                {.key = "difference"}}};
};

// What fits on a screen of a comparison: figures of the run, the stages that differ most, and why.

}  // namespace

Json comparison_json(const RunComparison& c) {
  Json json;
  json["format"] = "leviosim comparison";
  json["version"] = 1;
  for (const auto& [key, run] : {std::pair{"a", &c.a}, {"b", &c.b}}) {
    json[key]["name"] = run->name;
    json[key]["facts"] = facts_json(run->facts);
  }
  json["notes"] = c.notes;
  json["same_work"] = c.same_work();
  json["figures"] = list_json(c.figures);
  for (const MainCause& cause : worth_naming(main_causes(timed_parts(c.a), timed_parts(c.b))))
    json["why"].push_back(
        {{"text", cause_text(cause)}, {"ms", rounded(cause.ms)}, {"stage", cause.stage}});
  if (c.a.facts.measured || c.b.facts.measured)
    for (const ModelError& e : model_errors(c))
      json["model_errors"].push_back({{"stage", e.stage},
                                      {"measured", value_of(e.measured)},
                                      {"model", value_of(e.model)},
                                      {"percent", value_of(e.percent)}});
  json["stages"] = Json::array();
  for (const StageComparison& s : c.stages) json["stages"].push_back(stage_json(s));
  json["frame"] = quantity_json(c.frame);
  json["blocks"] = list_json(c.blocks);
  json["energy_by_stage"] = quantity_json(c.energy_by_stage);
  json["energy_by_domain"] = quantity_json(c.energy_by_domain);
  return json;
}

std::string comparison_csv(const RunComparison& c) {
  CsvRows rows;
  for (const ComparedQuantity& q : c.figures) rows.add("run", q.name, q);
  for (const StageComparison& s : c.stages) {
    for (const ComparedQuantity* q : {&s.calls, &s.operations, &s.single, &s.parallel, &s.share})
      rows.add(s.stage.name, q->name, *q);
    if (!s.mechanisms) continue;
    rows.add(s.stage.name, "cycles of a frame by mechanism", *s.mechanisms);
    rows.add(s.stage.name, "cycles of a frame by fork", *s.forks);
    for (const auto& [name, cycles] : {std::pair{"work", s.causes.work},
                                       {"cost", s.causes.cost},
                                       {"contention", s.causes.contention}})
      rows.add(s.stage.name, "cycles of a frame by cause", {name, "cycles", 0.0, cycles}, name);
  }
  for (const ComparedQuantity& q : c.blocks) rows.add("memory", q.name, q);
  rows.add("energy", "by stage", c.energy_by_stage);
  rows.add("energy", "by domain", c.energy_by_domain);
  return rows.text();
}

// A model against a measurement: the error of each stage.

}  // namespace leviosim::tools
