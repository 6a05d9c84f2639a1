#include "tools/app/validation/calibration/stage_model.h"

#include <fmt/format.h>

#include "sim/base/error.h"
#include "tools/app/validation/references.h"

namespace leviosim::tools {
namespace {

double paper_cycles(const std::vector<Reference>& references, std::string_view key) {
  for (const Reference& reference : references)
    if (reference.name == fmt::format("compute.{}.single", key)) return reference.value * 1e3;
  throw InputError(fmt::format("paper.csv: compute.{}.single is missing", key));
}

/// Cycles of the operations alone, with their code at hand.
double cost_of(const sim::WorkSum& work, const sim::ChipConfig& chip) {
  return work.cost(chip.cluster.core).total();
}

}  // namespace

double StageModel::cycles(const sim::ChipConfig& chip) const {
  return (cost_of(work, chip) + fixed) / static_cast<double>(frames);
}

std::vector<StageModel> stage_models(const FrameLog& log, const sim::ChipConfig& chip) {
  const std::vector<Reference> references = paper_references();
  std::vector<StageModel> models;
  for (const PaperStage& stage : kPaperStages) {
    const StageSum sum = sum_over(log.frames(), stage);
    if (sum.frames == 0)
      throw InputError(
          fmt::format("no frame of the run came to {}; choose more frames or other "
                      "data",
                      stage.title));
    StageModel model;
    model.key = stage.key;
    model.title = stage.title;
    model.frames = sum.frames;
    model.work = sum.work;
    model.fixed = static_cast<double>(sum.single.count()) - cost_of(sum.work, chip);
    model.reference = paper_cycles(references, stage.key);
    models.push_back(std::move(model));
  }
  return models;
}

}  // namespace leviosim::tools
