#include "tools/app/run/least_memory.h"

#include <fmt/core.h>

#include <algorithm>

#include "sim/base/interruption.h"
#include "sim/work/arena.h"
#include "tools/app/run/feed.h"
#include "tools/app/run/live_source.h"
#include "tools/app/run/workload.h"
#include "workload/vio/odometry/odometry.h"
#include "workload/vio/parameters.h"

namespace leviosim::tools {
namespace {

constexpr std::int64_t kKib = 1024;
constexpr Bytes kMostL1{16 * kKib * kKib};
constexpr Bytes kAnyL2{std::int64_t{1} << 28};

/// @throws work::MemoryOverflow
void fly_in(const RunRequest& request, const vio::Profile& profile, Bytes l1) {
  Feed feed(request);
  work::MachineConfig config = cluster_machine(request, profile.l1_alignment, l1);
  config.record = false;
  work::Machine cluster(config);
  work::Machine controller({.cores = 1, .memory = "L2", .capacity = kAnyL2});
  const auto odometry = vio::make_odometry(false, profile, feed.rig(), cluster, controller);
  for (int i = 0; i < feed.size(); ++i) {
    throw_if_interrupted();
    const bool optimising = odometry->begin_optimisation();
    odometry->process_frame(feed.frame(i));
    for (int k = 0; optimising && k < profile.optimiser_iterations; ++k) odometry->optimise();
    if (optimising) odometry->publish();
  }
}

/// What is missing in an L1; 0 if it is enough.
Bytes missing_in(const RunRequest& request, const vio::Profile& profile, Bytes l1) {
  try {
    fly_in(request, profile, l1);
    return Bytes(0);
  } catch (const work::MemoryOverflow& overflow) {
    return std::max(overflow.missing(), Bytes(1));
  }
}

}  // namespace

std::optional<Bytes> least_l1(const RunRequest& request, Bytes from) {
  if (vio::other_profile(request.profile) != nullptr) return std::nullopt;
  const vio::Profile profile = profile_of(request);
  const Bytes kib(kKib);
  Bytes failed(from.count() / kKib * kKib);
  Bytes works = failed + kib;
  for (Bytes missing = missing_in(request, profile, works); missing > Bytes(0);
       missing = missing_in(request, profile, works)) {
    failed = works;
    works += Bytes((missing.count() + kKib - 1) / kKib * kKib);
    if (works > kMostL1) return std::nullopt;
  }
  // Tiles of another size may need less than was missing.
  while (works - kib > failed && missing_in(request, profile, works - kib) == Bytes(0))
    works -= kib;
  return works;
}

std::string larger_memory(const RunRequest& request, const work::MemoryOverflow& overflow) {
  if (overflow.memory() == "L2") return "a larger l2.size has more";
  const Bytes all = request.platform.config.cluster.l1.size;
  const bool is_odometry = vio::other_profile(request.profile) == nullptr;
  const Bytes had = is_odometry ? l1_of(request, profile_of(request)) : all;
  const std::optional<Bytes> least = least_l1(request, had);
  const auto kib = [](Bytes size) { return (size.count() + 1023) / 1024; };
  if (least && *least <= all)
    return fmt::format("workload.l1={}KiB is the least in which a native run works", kib(*least));
  if (least)
    return fmt::format("cluster.l1.size={}KiB is the least in which a native run works",
                       kib(*least));
  return "a larger cluster.l1.size has more";
}

}  // namespace leviosim::tools
