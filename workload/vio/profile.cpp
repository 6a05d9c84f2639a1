#include "workload/vio/profile.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "workload/vio/parameters.h"

namespace leviosim::vio {
namespace {

/// Found by a random search over these three, the damping and the gates of observations, on the
/// real frames of MH_01 (5 to 20 s) with four random seeds each: without a prior on the velocity
/// the scale of the map drifts. The initial velocity is that of something held in the hand, half a
/// metre per second in all: a recording need not begin at rest, and if one that does not were tied
/// to zero, its map would begin with a wrong scale.
AnchorOptions levio_anchor() {
  AnchorOptions anchor;
  anchor.rotation = 0.01f;
  anchor.position = 0.001f;
  anchor.velocity = 0.02f;
  anchor.initial_velocity = 0.3f;
  return anchor;
}

/// As the released program has it (PARAMETERS.md#optimiser).
void make_levio(Profile& p) {
  p.optimiser.initial_lambda = 1e-3f;
  p.optimiser.min_lambda = 1e-8f;
}

/// What improves on the paper's pipeline and fits GAP9. Random walks are those of EuRoC's
/// sensor.yaml, noise densities twice (gyro) and ten times (accelerometer) those: white noise is
/// not all that is wrong with a sample (scale factors, vibration, the trapezoidal rule). A detector
/// finds a corner again within half a pixel only, patches agree better. A low resolution needs a
/// long base line: more keyframes, farther apart. The rest are the defaults of the options.
/// workload/ACCURACY.md says how these were found.
void make_next(Profile& p) {
  p.guided.enabled = true;
  p.patches.enabled = true;
  p.extractor.subpixel_steps = 16;
  p.extractor.max_corner_shift = 0;  // only patches move a feature
  p.refinement.rotation = 0.01f;     // the IMU predicts a frame better than one image tells it
  p.refinement.position = 0.03f;
  p.recovery.min_tracked = 150;
  p.max_observations = 4000;
  p.alignment.enabled = true;
  p.initial_wait = 2.0f;  // an alignment takes one to two seconds on a chip
  p.keyframe_parallax = 0.06f;
  p.optimiser_keyframes = 12;
  p.max_observation_error_sq = 9.0f;
  p.optimiser.joint = true;
  p.optimiser.prior.rest_gyro_bias = 0.002f;  // of a mean of 100 samples
  p.imu_noise = {
      .gyro = 3e-4f, .accel = 2e-2f, .gyro_bias = 1.9393e-5f, .accel_bias = 3e-3f, .gravity = 0.0f};
  p.imu_uncertainty.enabled = true;
  p.optimiser.visual.sigma_px = 0.5f;
  p.optimiser.prior.velocity = 0.3f;  // as levio's anchor, and for the same reason
}

struct NamedProfile {
  std::string_view name;
  std::string_view description;
  void (*adjust)(Profile&);  ///< starts from the defaults, which are `levio`
};

constexpr std::array kProfiles = {
    NamedProfile{"levio", "as the paper has it", make_levio},
    NamedProfile{"levio-no-imu", "without inertial terms in the optimiser",
                 [](Profile& p) {
                   make_levio(p);
                   p.use_imu = p.optimiser.use_imu = false;
                 }},
    NamedProfile{"levio-no-imu-no-epnp", "8-point poses only, without inertial terms",
                 [](Profile& p) {
                   make_levio(p);
                   p.use_imu = p.optimiser.use_imu = p.use_epnp = false;
                 }},
    NamedProfile{"next", "the best accuracy that fits GAP9", make_next},
    NamedProfile{"next-loop", "next, with loop closure",
                 [](Profile& p) {
                   make_next(p);
                   p.loop.enabled = true;
                 }},
};

const NamedProfile* find(std::string_view name) {
  const auto* it = std::find_if(kProfiles.begin(), kProfiles.end(),
                                [&](const NamedProfile& p) { return p.name == name; });
  return it == kProfiles.end() ? nullptr : it;
}

}  // namespace

/// What waits takes memory: more than so many frames do not, however many a camera sends.
constexpr float kMostWaiting = 200;

int Profile::frames_that_wait(float frame_rate) const {
  const float frames = initialises() ? std::min(initial_wait * frame_rate, kMostWaiting) : 0;
  const int whole = static_cast<int>(frames);
  return whole + (static_cast<float>(whole) < frames ? 1 : 0);
}

Profile profile_named(std::string_view name, std::uint32_t seed) {
  expect_profile(name);
  Profile profile;
  profile.name = name;
  profile.optimiser.anchor = levio_anchor();
  profile.sampling_seed = seed * 0x9e3779b1u + 1;  // an odd factor keeps different seeds apart
  if (const NamedProfile* const it = find(name)) it->adjust(profile);
  return profile;
}

bool uses_imu(std::string_view profile) { return profile_named(profile, 1).use_imu; }

void expect_profile(std::string_view name) {
  if (find(name) == nullptr && other_profile(name) == nullptr)
    throw InputError(fmt::format("unknown profile '{}'; known profiles are {}{}", name,
                                 fmt::join(profile_names(), ", "),
                                 base::did_you_mean(name, profile_names())));
}

std::vector<std::string> profile_names() {
  std::vector<std::string> names;
  for (const NamedProfile& p : kProfiles) names.emplace_back(p.name);
  for (const OtherProfile& p : other_profiles()) names.push_back(p.name);
  return names;
}

std::string_view profile_description(std::string_view name) {
  if (const OtherProfile* const other = other_profile(name)) return other->description;
  const NamedProfile* const it = find(name);
  check(it != nullptr, "a profile of this name");
  return it->description;
}

}  // namespace leviosim::vio
