#include "traces/synthesis/synthetic.h"

#include <fmt/core.h>

#include <cmath>
#include <vector>

#include "sim/base/error.h"
#include "traces/datasets/asl_writer.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/flight_images.h"
#include "traces/synthesis/imu_synthesis.h"
#include "traces/synthesis/motion.h"
#include "traces/synthesis/renderer.h"
#include "traces/synthesis/world.h"

namespace leviosim::traces {
namespace {

/// Parts of the flight that have a seed of their own.
enum SeedPart : std::uint64_t { kWorldSeed, kMotionSeed, kImuSeed, kImageSeed };

void check_options(const SyntheticOptions& options) {
  constexpr double kLongestS = 3600;
  if (!(options.duration_s > 0) || options.duration_s > kLongestS)
    throw InputError(fmt::format("synthetic flight: duration {} s; expected above 0, at most {} s",
                                 options.duration_s, kLongestS));
  if (!(options.image_noise >= 0) || options.image_noise > 255)
    throw InputError(fmt::format("synthetic flight: image noise {}; expected 0 to 255 grey levels",
                                 options.image_noise));
  if (!(options.texel_m >= 0.001) || options.texel_m > 0.1)
    throw InputError(
        fmt::format("synthetic flight: texel {} m; expected 0.001 to 0.1 m", options.texel_m));
}

std::int64_t step_ns(double rate_hz, std::int64_t step) {
  return static_cast<std::int64_t>(std::llround(static_cast<double>(step) * 1e9 / rate_hz));
}

/// The stamps kFirstFrameNs + i / rate for i = first ... last.
std::vector<std::int64_t> stamps(double rate_hz, std::int64_t first, std::int64_t last) {
  std::vector<std::int64_t> result;
  for (std::int64_t i = first; i <= last; ++i)
    result.push_back(SyntheticOptions::kFirstFrameNs + step_ns(rate_hz, i));
  return result;
}

std::vector<std::int64_t> frame_stamps(const SyntheticOptions& options) {
  const double frames = std::ceil(options.duration_s * options.camera.rate_hz - 1e-9);
  return stamps(options.camera.rate_hz, 0, static_cast<std::int64_t>(frames) - 1);
}

std::vector<std::int64_t> imu_stamps(const SyntheticOptions& options, std::int64_t last_frame_ns) {
  const double rate = options.imu.rate_hz;
  const double lead = std::ceil(rate / options.camera.rate_hz);
  const double span_s = static_cast<double>(last_frame_ns - SyntheticOptions::kFirstFrameNs) * 1e-9;
  return stamps(rate, -static_cast<std::int64_t>(lead),
                static_cast<std::int64_t>(std::ceil(span_s * rate - 1e-6)));
}

void write_text(outputs::OutputFolder& out, const SyntheticOptions& options, const Motion& motion,
                const std::vector<std::int64_t>& frames) {
  ImuSynthesizer imu(options.imu, derive_seed(options.seed, kImuSeed));
  const ImuTrack track =
      record_imu(motion, options.imu_errors ? &imu : nullptr, SyntheticOptions::kFirstFrameNs,
                 imu_stamps(options, frames.back()));
  const std::string comment = fmt::format("leviosim synthetic flight, seed {}", options.seed);
  const auto write = [&out](const char* name, const std::string& text) {
    out.write(std::string("mav0/") + name, text);
  };
  write("cam0/sensor.yaml", format_camera_yaml(options.camera, comment));
  write("cam0/data.csv", format_frames_csv(frames));
  write("imu0/sensor.yaml", format_imu_yaml(options.imu, comment));
  write("imu0/data.csv", format_imu_csv(track.samples));
  write("state_groundtruth_estimate0/sensor.yaml", format_ground_truth_yaml(comment));
  write("state_groundtruth_estimate0/data.csv", format_ground_truth_csv(track.truth));
}

void write_images(outputs::OutputFolder& out, const SyntheticOptions& options, const Motion& motion,
                  const std::vector<std::int64_t>& frames, const FlightProgress& progress) {
  const World world =
      make_room(derive_seed(options.seed, kWorldSeed), options.texel_m, options.threads);
  RenderOptions render_options;
  render_options.noise = options.image_noise;
  render_options.seed = derive_seed(options.seed, kImageSeed);
  const Renderer renderer(world, options.camera, render_options);
  const auto draw = [&](std::size_t i) {
    const double t_s = static_cast<double>(frames[i] - SyntheticOptions::kFirstFrameNs) * 1e-9;
    return renderer.render(motion.at(t_s).T_world_body * options.camera.T_body_camera, i);
  };
  write_flight_images(out, frames, {renderer.width(), renderer.height()}, draw, options.threads,
                      progress);
}

}  // namespace

void write_synthetic_flight(const std::filesystem::path& out_dir, const SyntheticOptions& options,
                            const FlightProgress& progress) {
  check_options(options);
  outputs::OutputFolder out({.option = {},
                             .path = out_dir.string(),
                             .replace = options.overwrite || options.repair,
                             .repair = options.repair});
  const HandHeldFlight motion(derive_seed(options.seed, kMotionSeed));
  const std::vector<std::int64_t> frames = frame_stamps(options);
  const auto pixels = static_cast<std::uint64_t>(options.camera.width) *
                      static_cast<std::uint64_t>(options.camera.height);
  out.reserve(frames.size() * pixels / 2);  // rather less: pictures with noise
  write_text(out, options, motion, frames);
  write_images(out, options, motion, frames, progress);
  commit_flight(out);
}

}  // namespace leviosim::traces
