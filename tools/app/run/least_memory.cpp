#include "tools/app/run/least_memory.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>

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
constexpr Bytes kLargest{16 * kKib * kKib};
constexpr Bytes kAnyL2{std::int64_t{1} << 28};

/// @throws work::MemoryOverflow
void fly_in(const RunRequest& request, const vio::Profile& profile, Bytes l1, Bytes l2) {
  Feed feed(request);
  work::MachineConfig cluster_config = cluster_machine(request, profile.l1_alignment, l1);
  work::MachineConfig controller_config = controller_machine(request, l2);
  cluster_config.record = controller_config.record = false;
  work::Machine cluster(cluster_config), controller(controller_config);
  const auto odometry = vio::make_odometry(false, profile, feed.rig(), cluster, controller);
  for (int i = 0; i < feed.size(); ++i) {
    throw_if_interrupted();
    const bool optimising = odometry->begin_optimisation();
    odometry->process_frame(feed.frame(i));
    for (int k = 0; optimising && k < profile.optimiser_iterations; ++k) odometry->optimise();
    if (optimising) odometry->publish();
  }
}

/// What is missing for a flight; 0 if nothing is. Absent if another memory than L2, or than L1,
/// overflows.
std::optional<Bytes> missing_in(const RunRequest& request, Bytes l1, Bytes l2, bool of_l2) {
  try {
    fly_in(request, profile_of(request), l1, l2);
    return Bytes(0);
  } catch (const work::MemoryOverflow& overflow) {
    if ((overflow.memory() == "L2") != of_l2) return std::nullopt;
    return std::max(overflow.missing(), Bytes(1));
  }
}

/// The least size in which nothing is missing.
std::optional<Bytes> least(Bytes from,
                           const std::function<std::optional<Bytes>(Bytes size)>& missing) {
  const Bytes kib(kKib);
  Bytes failed(from.count() / kKib * kKib);
  Bytes works = failed + kib;
  std::optional<Bytes> more = missing(works);
  for (; more && *more > Bytes(0); more = missing(works)) {
    failed = works;
    works += Bytes((more->count() + kKib - 1) / kKib * kKib);
    if (works > kLargest) return std::nullopt;
  }
  if (!more) return std::nullopt;
  // Tiles of another size may need less than was missing.
  while (works - kib > failed && missing(works - kib) == Bytes(0)) works -= kib;
  return works;
}

bool is_odometry(const RunRequest& request) {
  return vio::other_profile(request.profile) == nullptr;
}

}  // namespace

std::optional<Bytes> least_l1(const RunRequest& request, Bytes from) {
  if (!is_odometry(request)) return std::nullopt;
  return least(from, [&](Bytes l1) { return missing_in(request, l1, kAnyL2, false); });
}

std::optional<Bytes> least_l2(const RunRequest& request, Bytes from) {
  if (!is_odometry(request)) return std::nullopt;
  const Bytes l1 = l1_of(request, profile_of(request));
  return least(from, [&](Bytes l2) { return missing_in(request, l1, l2, true); });
}

std::string larger_memory(const RunRequest& request, const work::MemoryOverflow& overflow) {
  const auto kib = [](Bytes size) { return (size.count() + kKib - 1) / kKib; };
  if (overflow.memory() == "L2") {
    const std::optional<Bytes> least = least_l2(request, request.platform.config.l2.size);
    if (!least) return "a larger l2.size has more";
    return fmt::format("l2.size={}KiB is the least in which a native run works", kib(*least));
  }
  const Bytes all = request.platform.config.cluster.l1.size;
  const Bytes had = is_odometry(request) ? l1_of(request, profile_of(request)) : all;
  const std::optional<Bytes> least = least_l1(request, had);
  if (least && *least <= all)
    return fmt::format("workload.l1={}KiB is the least in which a native run works", kib(*least));
  if (least)
    return fmt::format("cluster.l1.size={}KiB is the least in which a native run works",
                       kib(*least));
  return "a larger cluster.l1.size has more";
}

}  // namespace leviosim::tools
