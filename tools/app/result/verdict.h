// Whether a run does what it should: three verdicts, each with its reason. They are the same in
// what a command prints, in run.json, on pages and for budgets.
//
//   time    fits; fits on average: some frames come late; too slow: a mean frame takes longer than
//           the camera's period, so that frames pile up or are lost
//   memory  fits; does not fit
//   map     good; not judged: there is no truth, and the estimator does not watch its map;
//           unreliable; lost: the poses are worth nothing. Poses from before there was a map are
//           guesses: they are named, and not judged
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/result/run_figures.h"

namespace leviosim::tools {

/// As a figure, in baselines and budgets: 0 good, ½ unknown, 1 doubtful, 2 bad.
double severity(Grade grade);

/// The words of a kind of verdict, from the best on. Empty for another name.
struct VerdictWord {
  std::string_view about;
  std::string_view word;
  Grade grade;
};
const std::vector<VerdictWord>& verdict_words();

/// Of statistics and of the signs of the map; readers find them in RunFigures::verdicts.
Verdicts verdicts_of(const RunFigures& run);

/// On shorter paths the scale and a small error say nothing of the map; a large error is taken as a
/// share of this length.
inline constexpr double kShortestPath_m = 1;

/// Beyond these a map is unreliable, or lost. Drift of published estimators is 1 % of the path or
/// less, and a scale within a few per cent; an error of a quarter of the path, or a path of twice
/// or half its size, is of no use to anybody who flies by it.
struct MapLimits {
  double error_share = 0.1;  ///< ATE over the length of the true path
  double lost_error_share = 0.25;
  double scale = 1.25;  ///< size of the estimated path over the true one, or the inverse
  double lost_scale = 2;
  double tilt_deg = 10;         ///< error of the vertical: nobody hovers by it
  double kept_s = 2;            ///< longest time without a new pose [s]
  double initialising_s = 5;    ///< longest initialisation [s]
  double restarts_per_s = 0.2;  ///< restarts of the map over time, if there are more than two [1/s]
  double features = 20;         ///< least mean number of features of a frame
};

/// By the truth where there is one, and by what the estimator says of its poses.
RunVerdict map_verdict(const MapSigns& signs, const MapLimits& limits = {});

/// Over all frames.
std::int64_t map_restarts(const RunResult& run);

}  // namespace leviosim::tools
