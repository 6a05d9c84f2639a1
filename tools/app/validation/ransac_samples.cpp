#include "tools/app/validation/ransac_samples.h"

#include <algorithm>
#include <cmath>

namespace leviosim::tools {
namespace {

using work::Op;

constexpr std::string_view kEpnp = "solve EPnP";
constexpr std::string_view kEightPoint = "8-point hypotheses";

double number(const work::Counts& counts, Op op) { return static_cast<double>(counts[op]); }
double rotations(const work::Counts& hypothesis) { return number(hypothesis, Op::F64Mul) / 2; }

/// In whole steps, at least the one that finds no pivot.
double steps(const work::Counts& hypothesis) {
  constexpr double kOutsideOfSteps = 21;
  constexpr double kOfAStep = 54;
  const double divisions = number(hypothesis, Op::F32Div) - rotations(hypothesis) - kOutsideOfSteps;
  return std::max(1.0, std::round(divisions / kOfAStep));
}

}  // namespace

void RansacSamples::add(const work::Job& job) {
  for (const work::StageRun& stage : job.stages)
    for (const work::Step& step : stage.steps) {
      const auto* fork = std::get_if<work::Fork>(&step);
      if (fork == nullptr || (fork->name != kEpnp && fork->name != kEightPoint)) continue;
      double most = 0;
      for (const work::Segment& hypothesis : fork->shares) {
        if (hypothesis.empty()) continue;
        if (fork->name == kEpnp) {
          epnp_rotations.push_back(rotations(hypothesis));
          continue;
        }
        eight_point_rotations.push_back(rotations(hypothesis));
        eight_point_steps.push_back(steps(hypothesis));
        most = std::max(most, eight_point_steps.back());
      }
      if (fork->name == kEightPoint) slowest_of_eight.push_back(most);
    }
}

}  // namespace leviosim::tools
