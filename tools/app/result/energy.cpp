#include "tools/app/result/energy.h"

#include <algorithm>
#include <cmath>

namespace leviosim::tools {
namespace {

using sim::Estimate;

std::optional<Estimate<Watts>> power_over(const Estimate<Joules>& energy, Seconds time) {
  if (!(time > Seconds(0))) return std::nullopt;
  return energy / time;
}

EnergyRow row_of(const RunResult& run, const StageResult& stage, const sim::ChipConfig& chip) {
  const sim::Activity activity =
      stage.on_controller ? sim::controller_activity(chip, stage.counts, stage.transfers,
                                                     stage.parallel, stage.served)
                          : sim::cluster_activity(chip, run.cores, stage.counts, stage.transfers,
                                                  stage.account.team, stage.parallel, stage.served);
  return {stage.name,
          stage.unit,
          stage.on_controller,
          stage.calls,
          stage.on_controller ? activity.controller_working : activity.time,
          sim::energy_of(activity, chip)};
}

Seconds cluster_time(const std::vector<EnergyRow>& rows) {
  Seconds sum;
  for (const EnergyRow& row : rows)
    if (!row.on_controller) sum += row.time;
  return sum;
}

/// Until a period after the camera's last frame, dropped or not, or until the last pose.
Seconds duration(const CameraRecord& camera, const RunResult& run) {
  std::int64_t end_ns = run.frames.empty() ? 0 : run.frames.back().end_ns;
  if (!camera.deliveries.empty())
    end_ns = std::max(end_ns, camera.deliveries.back().arrival_ns + run.frame_period_ns);
  return Seconds(static_cast<double>(end_ns) * 1e-9);
}

Seconds duration(const RunResult& run, const sim::ChipConfig& chip) {
  if (run.camera) return duration(*run.camera, run);
  if (run.frames.empty()) return Seconds(0);
  const auto camera_ns = static_cast<double>(run.frames.back().arrival_ns + run.frame_period_ns);
  Cycles front_end;
  for (const FrameResult& frame : run.frames) front_end += frame.cycles;
  return std::max(Seconds(camera_ns * 1e-9),
                  sim::seconds(static_cast<double>(front_end.count()), chip.cluster.clock));
}

RunEnergy energy_on(const RunResult& run, const sim::ChipConfig& chip) {
  RunEnergy energy;
  energy.frames = static_cast<std::int64_t>(run.frames.size());
  energy.time = duration(run, chip);
  for (const StageResult& stage : run.stages) energy.rows.push_back(row_of(run, stage, chip));
  const Seconds idle = std::max(energy.time - cluster_time(energy.rows), Seconds(0));
  energy.rows.push_back({kIdle, "frame", false, energy.frames, idle,
                         sim::energy_of(sim::idle_activity(chip, run.cores, idle), chip)});
  return energy;
}

std::optional<Estimate<Watts>> power_of_stages(const RunEnergy& run, bool on_controller) {
  Estimate<Joules> energy;
  Seconds time;
  for (const EnergyRow& row : run.rows) {
    if (row.on_controller != on_controller || row.name == kIdle) continue;
    energy += row.energy.total();
    time += row.time;
  }
  return power_over(energy, time);
}

}  // namespace

std::optional<Estimate<Joules>> EnergyRow::per_call() const {
  if (calls == 0) return std::nullopt;
  return energy.total() * (1.0 / static_cast<double>(calls));
}

std::optional<Estimate<Watts>> EnergyRow::power() const { return power_over(energy.total(), time); }

sim::DomainEnergies RunEnergy::total() const {
  sim::DomainEnergies sum;
  for (const EnergyRow& row : rows) sum += row.energy;
  return sum;
}

std::optional<Estimate<Joules>> RunEnergy::per_frame() const {
  if (frames == 0) return std::nullopt;
  return total().total() * (1.0 / static_cast<double>(frames));
}

std::optional<Estimate<Watts>> RunEnergy::mean_power() const {
  return power_over(total().total(), time);
}

std::optional<Estimate<Watts>> RunEnergy::power_of_front_end() const {
  return power_of_stages(*this, false);
}

std::optional<Estimate<Watts>> RunEnergy::power_of_controller() const {
  return power_of_stages(*this, true);
}

std::optional<RunEnergy> energy_of(const RunResult& run) {
  if (!run.timed || !sim::knows_energy(run.chip)) return std::nullopt;
  return energy_on(run, run.chip);
}

std::optional<RunEnergy> energy_at(const RunResult& run, const sim::OperatingPoint& point) {
  if (!run.timed || run.camera || !sim::knows_energy(run.chip)) return std::nullopt;
  sim::ChipConfig chip = run.chip;
  const Hertz faster = std::max(chip.cluster.clock, chip.controller.clock);
  const double ratio =
      static_cast<double>(point.clock.count()) / static_cast<double>(faster.count());
  for (Hertz* clock : {&chip.cluster.clock, &chip.controller.clock})
    *clock = Hertz(std::llround(static_cast<double>(clock->count()) * ratio));
  chip.supply.voltage = point.voltage;
  return energy_on(run, chip);
}

}  // namespace leviosim::tools
