// Published power of GAP9, that the energy model is held against. None of it entered the model,
// except that the static part of the chip (energy.soc.static) was derived from the MLPerf pairs.
#pragma once

#include <array>
#include <string_view>

namespace leviosim::validation {

/// Viola-Jones detection on the cluster's cores, 240 MHz, 0.65 V, whole chip [mW]. Bompani et al.,
/// pest detection on GAP9, 2024 (FACTS.md#published-power). Measured.
inline constexpr double kViolaJones_mW = 20.5;

/// MLPerf Tiny v1.0, whole chip with its regulator, mlcommons/tiny_results_v1.0 commit c7761cf
/// (FACTS.md#measured-power). Measured: energy of an inference times inferences per second.
struct MlperfTask {
  std::string_view name;
  double mw_at_240;  ///< MHz, 0.65 V
  double mw_at_370;  ///< MHz, 0.80 V
};
inline constexpr std::array kMlperf{
    MlperfTask{"anomaly detection", 19.34, 41.44},
    MlperfTask{"image classification", 28.92, 64.89},
    MlperfTask{"keyword spotting", 25.39, 56.20},
    MlperfTask{"visual wake words", 23.58, 51.97},
};

/// P = a V² f + s V through the two points of a task: the range of a over the tasks
/// [mW / (V² MHz)] and of s V at 0.65 V [mW] (FACTS.md#measured-power). Derived.
inline constexpr double kLeastA = 0.157;
inline constexpr double kMostA = 0.262;
inline constexpr double kLeastStatic_mW = 2.4;
inline constexpr double kMostStatic_mW = 3.4;

/// LEVIO, 370 MHz: the paper says less than this, without a measurement (FACTS.md#published-power)
/// [mW].
inline constexpr double kLevioClaim_mW = 100;
/// What FACTS.md expects of its front end with the optimiser running (FACTS.md#energy-per-event)
/// [mW].
inline constexpr double kLevioExpectedLow_mW = 45;
inline constexpr double kLevioExpectedHigh_mW = 65;

}  // namespace leviosim::validation
