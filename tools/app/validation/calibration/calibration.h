// What a fit to the paper would ask for: the factor on all instructions of compiled code with which
// the six single-core values of its table come out best, by least squares of the logarithms of
// simulated over published, every stage with the same weight. The model has no such factor, so a
// sound one is near 1: this is a check, and nothing is set by it.
//
// Means of a call are compared as they are. The paper prints no inputs, so a factor makes up for
// what its frames have more or less of: their number of keypoints, first of all
// (validation.h: with_paper_keypoints()).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/chip/config.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/validation/frame_log.h"

namespace leviosim::tools {

/// A mean call of a stage on one core: where nothing contends, its time is a line over the factor.
struct StageOnOneCore {
  std::string_view title;
  double reference = 0;     ///< the paper's cycles
  double cycles = 0;        ///< cycles with the factor 1
  double instructions = 0;  ///< part that the factor multiplies: without routines and waits

  double with(double factor) const { return cycles + (factor - 1) * instructions; }
};

/// The six stages of the paper's table.
/// @throws InputError if the run has no frame of a stage
std::vector<StageOnOneCore> stages_on_one_core(const FrameLog& log, const sim::ChipConfig& chip);

struct FactorFit {
  double factor = 1;
  double error = 0;  ///< its standard error, from what the fit leaves of the stages
};

/// @param stages  two or more, with instructions
FactorFit fit_factor(const std::vector<StageOnOneCore>& stages);

/// The fit to the stages but one.
double factor_without(const std::vector<StageOnOneCore>& stages, const StageOnOneCore& left_out);

/// Of a simulated over a measured value, in per cent.
double percent_error(double simulated, double reference);
/// Mean of the absolute errors over the stages, in per cent.
double mean_error(const std::vector<StageOnOneCore>& stages, double factor);

/// Each stage as it is, with the factor, and with the one that the others ask for.
std::string factor_table(const std::vector<StageOnOneCore>& stages);
/// The factor, in a sentence.
std::string factor_conclusion(const std::vector<StageOnOneCore>& stages);
Json factor_json(const std::vector<StageOnOneCore>& stages);

}  // namespace leviosim::tools
