#include "tools/app/result/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "sim/base/check.h"
#include "sim/chip/accelerator.h"
#include "tools/app/result/camera_figures.h"
#include "tools/app/result/energy_summary.h"

namespace leviosim::tools {
namespace {

enum : std::size_t { kEpnp = 0, kEightPoint = 2, kTracked = 4, kPredicted = 6, kOther = 8 };

/// By the means that found the pose; the number after it is that of the kind with keyframe.
std::size_t scenario_of(const FrameResult& frame) {
  const std::size_t keyframe = frame.keyframe ? 1 : 0;
  switch (frame.source) {
    case PoseSource::Epnp:
      return kEpnp + keyframe;
    case PoseSource::EightPoint:
      return kEightPoint + keyframe;
    case PoseSource::Tracked:
      return kTracked + keyframe;
    case PoseSource::Predicted:
      return kPredicted + keyframe;
    default:
      return kOther;
  }
}

std::vector<Scenario> empty_scenarios() {
  constexpr std::array<std::array<std::string_view, 2>, kOther + 1> names{{
      {"EPnP", "epnp"},
      {"EPnP, keyframe", "epnp_keyframe"},
      {"8-point", "eight_point"},
      {"8-point, keyframe", "eight_point_keyframe"},
      {"tracked", "tracked"},
      {"tracked, keyframe", "tracked_keyframe"},
      {"predicted", "predicted"},
      {"predicted, keyframe", "predicted_keyframe"},
      {"other (first, initialising, pose kept)", "other"},
  }};
  std::vector<Scenario> all;
  for (const auto& [name, key] : names) {
    Scenario scenario;
    scenario.name = name;
    scenario.key = key;
    all.push_back(scenario);
  }
  return all;
}

using sim::Estimate;

std::optional<Estimate<Watts>> power_over(const Estimate<Joules>& energy, Seconds time) {
  if (!(time > Seconds(0))) return std::nullopt;
  return energy / time;
}

/// With what external memory takes, if it keeps something.
sim::DomainEnergies energy_with_external(const RunResult& run, sim::Activity activity,
                                         const sim::ChipConfig& chip) {
  if (!run.external.empty()) activity.external_on = activity.time;
  return sim::energy_of(activity, chip);
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
          energy_with_external(run, activity, chip)};
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

/// For which the camera sends frames, or longer if the chip works longer. Of a chip with one core
/// front end and optimiser take turns.
Seconds duration(const RunResult& run, const sim::ChipConfig& chip,
                 const std::vector<EnergyRow>& rows) {
  if (run.camera) return duration(*run.camera, run);
  if (run.frames.empty()) return Seconds(0);
  const auto camera_ns = static_cast<double>(run.frames.back().arrival_ns + run.frame_period_ns);
  Cycles front_end;
  for (const FrameResult& frame : run.frames) front_end += frame.cycles;
  Seconds work = sim::seconds(static_cast<double>(front_end.count()), chip.cluster.clock);
  if (chip.controller.shares_core)
    for (const EnergyRow& row : rows)
      if (row.on_controller) work += row.time;
  return std::max(Seconds(camera_ns * 1e-9), work);
}

/// @param time  of the run; as long as it takes if absent
RunEnergy energy_on(const RunResult& run, const sim::ChipConfig& chip,
                    std::optional<Seconds> time = {}) {
  RunEnergy energy;
  energy.frames = static_cast<std::int64_t>(run.frames.size());
  for (const StageResult& stage : run.stages) energy.rows.push_back(row_of(run, stage, chip));
  energy.time = time ? *time : duration(run, chip, energy.rows);
  const Seconds idle = std::max(energy.time - cluster_time(energy.rows), Seconds(0));
  energy.rows.push_back(
      {kIdle, "frame", false, energy.frames, idle,
       energy_with_external(run, sim::idle_activity(chip, run.cores, idle), chip)});
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

std::string key_of(std::string_view name) {
  std::string key;
  for (const char c : name) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (letter)
      key += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    else if (!key.empty() && key.back() != '_')
      key += '_';
  }
  while (!key.empty() && key.back() == '_') key.pop_back();
  return key;
}

std::optional<double> mean(Cycles sum, std::int64_t calls) {
  if (calls == 0) return std::nullopt;
  return static_cast<double>(sum.count()) / static_cast<double>(calls);
}

std::optional<double> speedup(const StageResult& stage) {
  if (stage.calls == 0 || stage.parallel.count() == 0) return std::nullopt;
  return static_cast<double>(stage.single.count()) / static_cast<double>(stage.parallel.count());
}

std::optional<double> unmeasured_share(const StageResult& stage) {
  if (stage.single.count() == 0) return std::nullopt;
  // As one core runs them, words of some shares straddle less.
  return std::min(1.0, stage.unmeasured / static_cast<double>(stage.single.count()));
}

Hertz clock_of(const RunResult& run, const StageResult& stage) {
  return stage.on_controller ? run.controller_clock : run.cluster_clock;
}

double milliseconds(double cycles, Hertz clock) {
  return cycles * 1e3 / static_cast<double>(clock.count());
}

std::size_t expected_poses(const RunResult& run) {
  return run.camera ? run.camera->deliveries.size() : run.frames.size();
}

std::string why_incomparable(const RunResult& run) {
  if (!run.not_comparable.empty() || run.poses_left_out == 0) return run.not_comparable;
  return fmt::format("{} poses are NaN", run.poses_left_out);
}

std::optional<traces::Trajectory> located_poses(const RunResult& run) {
  constexpr std::size_t kFewestLocated = 20;
  std::set<std::int64_t> guessed_ns;
  for (const FrameResult& frame : run.frames)
    if (frame.pose_state() == vio::PoseState::Initialising) guessed_ns.insert(frame.t_ns);
  traces::Trajectory poses = run.trajectory;
  std::erase_if(poses,
                [&](const traces::StampedPose& pose) { return guessed_ns.contains(pose.t_ns); });
  if (poses.size() == run.trajectory.size() || poses.size() < kFewestLocated) return std::nullopt;
  return poses;
}

std::optional<double> Scenario::mean_latency_ns() const {
  if (frames == 0) return std::nullopt;
  return static_cast<double>(latency_ns) / static_cast<double>(frames);
}

std::vector<Scenario> scenarios(const RunResult& run) {
  std::vector<Scenario> all = empty_scenarios();
  for (const FrameResult& frame : run.frames) {
    Scenario& scenario = all[scenario_of(frame)];
    const std::int64_t latency_ns = frame.end_ns - frame.arrival_ns;
    ++scenario.frames;
    scenario.latency_ns += latency_ns;
    scenario.worst_latency_ns = std::max(scenario.worst_latency_ns, latency_ns);
    if (latency_ns > run.frame_period_ns) ++scenario.over_period;
    scenario.single += frame.single_cycles;
    scenario.parallel += frame.cycles;
  }
  // Those that not every profile has, from the last on, so that the numbers before stay right.
  for (const std::size_t kind : {kPredicted, kTracked}) {
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(kind);
    if (first[0].frames + first[1].frames == 0) all.erase(first, first + 2);
  }
  return all;
}

std::optional<FrameTimes> frame_times(const RunResult& run) {
  if (!run.timed || run.frames.empty()) return std::nullopt;
  std::vector<std::int64_t> own;
  for (const FrameResult& frame : run.frames) own.push_back(frame.end_ns - frame.start_ns);
  std::sort(own.begin(), own.end());
  const double mean =
      static_cast<double>(std::accumulate(own.begin(), own.end(), std::int64_t{0})) /
      static_cast<double>(own.size());
  const TimeBands bands = run.time_bands.value_or(TimeBands());
  FrameTimes times{mean * bands.mean, static_cast<double>(percentile(own, 0.99)) * bands.slowest,
                   static_cast<double>(own.back()) * bands.slowest};
  times.late = std::count_if(own.begin(), own.end(),
                             [&](std::int64_t ns) { return ns > run.frame_period_ns; });
  times.has_bands = run.time_bands.has_value();
  return times;
}

Waiting frames_that_waited(const RunResult& run) {
  Waiting waiting;
  for (const FrameResult& frame : run.frames) {
    const std::int64_t wait_ns = frame.start_ns - frame.arrival_ns;
    if (wait_ns > 0) ++waiting.frames;
    waiting.longest_ns = std::max(waiting.longest_ns, wait_ns);
  }
  return waiting;
}

std::vector<sim::MechanismInfo> breakdown_parts(const RunResult& run) {
  const bool in_cluster = run.timed && sim::has_accelerators(run.chip.cluster.accelerators);
  const bool anywhere = run.timed && sim::has_accelerators(run.chip);
  std::vector<sim::MechanismInfo> parts(sim::kMechanisms.begin(), sim::kMechanisms.end());
  std::erase_if(parts, [&](const sim::MechanismInfo& info) {
    return info.column.empty() || (info.mechanism == sim::Mechanism::Accelerator && !anywhere) ||
           (info.mechanism == sim::Mechanism::AcceleratorContention && !in_cluster);
  });
  return parts;
}

std::vector<BlockGroup> grouped(const std::vector<work::Block>& blocks) {
  std::vector<BlockGroup> groups;
  for (const work::Block& block : blocks) {
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const BlockGroup& g) { return g.name == block.name; });
    if (group == groups.end()) group = groups.insert(group, BlockGroup{block.name, 0, Bytes(0)});
    ++group->copies;
    group->bytes += block.size;
  }
  return groups;
}

double percent_of_nominal(Bytes used, Bytes size) {
  const double nominal = static_cast<double>(size.count()) / 1024.0 * 1000.0;
  return nominal > 0 ? 100.0 * static_cast<double>(used.count()) / nominal : 0;
}

std::string readable(double value, int decimals) {
  constexpr double kMost = 1e6;
  return std::abs(value) < kMost ? fmt::format("{:.{}f}", value, decimals)
                                 : fmt::format("{:.3g}", value);
}

std::string of_memory(Bytes used, Bytes size) {
  return fmt::format("{:.1f} of {:.1f} kB", static_cast<double>(used.count()) * 1e-3,
                     static_cast<double>(size.count()) * 1e-3);
}

double path_length(const std::vector<traces::StampedPose>& trajectory) {
  double length = 0;
  for (std::size_t i = 1; i < trajectory.size(); ++i)
    length +=
        (trajectory[i].T_world_body.translation() - trajectory[i - 1].T_world_body.translation())
            .norm();
  return length;
}

bool has_poses(const RunResult& run) {
  const auto is_origin = [](const traces::StampedPose& pose) {
    return pose.T_world_body.matrix() == Eigen::Matrix4d::Identity();
  };
  return run.trajectory.empty() || run.ate ||
         !std::all_of(run.trajectory.begin(), run.trajectory.end(), is_origin);
}

CameraFigures::Latencies latencies_of(const RunResult& run) {
  std::vector<std::int64_t> sorted;
  for (const FrameResult& frame : run.frames) sorted.push_back(frame.end_ns - frame.arrival_ns);
  if (sorted.empty()) return {};
  std::sort(sorted.begin(), sorted.end());
  return {percentile(sorted, 0.5), percentile(sorted, 0.95), percentile(sorted, 0.99),
          sorted.back()};
}

double CameraFigures::share_of(std::int64_t frames) const {
  return arrived > 0 ? static_cast<double>(frames) / static_cast<double>(arrived) : 0;
}

bool is_late(const soc::FrameTiming& frame, const RunSubject& run) {
  return frame.end_ns - frame.arrival_ns > run.frame_period_ns;
}

std::int64_t percentile(const std::vector<std::int64_t>& sorted, double share) {
  constexpr double kRounding = 1e-9;  // 0.95 · 20 is 19, not the number after it
  const double rank = std::ceil(share * static_cast<double>(sorted.size()) - kRounding);
  const auto index = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  check(index < sorted.size(), "a percentile is of values that exist");
  return sorted[index];
}

std::optional<CameraFigures> camera_figures(const RunResult& run) {
  if (!run.camera) return std::nullopt;
  CameraFigures figures;
  figures.arrived = static_cast<std::int64_t>(run.camera->deliveries.size());
  figures.processed = static_cast<std::int64_t>(run.frames.size());
  for (const soc::Delivery& delivery : run.camera->deliveries) {
    if (delivery.dropped) ++figures.dropped;
    figures.most_found = std::max(figures.most_found, delivery.found);
  }
  for (const FrameResult& frame : run.frames) {
    if (is_late(frame, run)) ++figures.late;
    if (frame.start_ns > frame.arrival_ns) ++figures.waited;
  }
  figures.latency = latencies_of(run);
  return figures;
}

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

std::optional<RunEnergy> energy_of(const RunResult& run, std::optional<Seconds> time) {
  if (!run.timed || !sim::knows_energy(run.chip)) return std::nullopt;
  return energy_on(run, run.chip, time);
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
