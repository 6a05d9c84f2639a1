// Energy of a run, derived when it is read out: of each stage, of the time in between, per frame,
// and the mean power at the camera's frame rate. Every joule is in one row and one domain.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/energy/model.h"
#include "tools/app/result/run_result.h"

namespace leviosim::tools {

/// A stage over the whole run, or the time without one.
struct EnergyRow {
  std::string name;
  std::string unit;  ///< unit of a call: "frame", "iteration"
  bool on_controller = false;
  std::int64_t calls = 0;
  Seconds time;  ///< of all calls
  sim::DomainEnergies energy;

  /// Absent if there were no calls.
  std::optional<sim::Estimate<Joules>> per_call() const;
  /// Mean while it runs: the whole chip without the controller's core for a stage of the cluster,
  /// what the controller adds to that for one of the controller.
  std::optional<sim::Estimate<Watts>> power() const;
};

/// Name of the row for the time in which the cluster has no work.
inline constexpr const char* kIdle = "cluster idle";

struct RunEnergy {
  std::vector<EnergyRow> rows;  ///< the stages in the run's order, and last the idle time
  std::int64_t frames = 0;
  /// From the first frame to a period after the last, or what the front end took if that is longer;
  /// in a closed loop, until the last pose if that is later.
  Seconds time;

  sim::DomainEnergies total() const;
  std::optional<sim::Estimate<Joules>> per_frame() const;
  std::optional<sim::Estimate<Watts>> mean_power() const;
  /// Of the stages of the cluster while one of them runs, and of the controller while it works.
  std::optional<sim::Estimate<Watts>> power_of_front_end() const;
  std::optional<sim::Estimate<Watts>> power_of_controller() const;
};

/// Absent if the run was not timed, or its platform has no energy figures.
/// @param time  that it takes, if that is not the time of the run
std::optional<RunEnergy> energy_of(const RunResult& run, std::optional<Seconds> time = {});

/// The same cycles at another operating point: the faster of the two clocks runs at the clock of
/// the point, the other one in proportion. What another speed changes in the computation (a
/// result that is published a frame later) is left out; of a closed loop, where it also changes
/// which frames are processed, there is no such estimate.
std::optional<RunEnergy> energy_at(const RunResult& run, const sim::OperatingPoint& point);

}  // namespace leviosim::tools
