#include "sim/chip/dma.h"

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"
#include "sim/events/timebase.h"

namespace leviosim::sim {
namespace {

constexpr double kWordBytes = 4;

double payload_cycles(const DmaConfig& dma, Bytes bytes) {
  return std::ceil(static_cast<double>(bytes.count()) / dma.bytes_per_cycle);
}

}  // namespace

double transfer_cycles(const DmaConfig& dma, Bytes bytes) {
  return dma.programming + std::max(dma.call, dma.first_data + payload_cycles(dma, bytes)) +
         dma.completion;
}

Dma::Dma(Kernel& kernel, const ClockDomain& clock, const DmaConfig& config, Team& team)
    : kernel_(kernel), clock_(clock), config_(config), team_(team) {}

Duration Dma::cycles(double n) const { return clock_.duration(counted_cycles(std::round(n))); }

Time Dma::room() {
  const Time now = kernel_.now();
  std::erase_if(under_way_, [&](Time end) { return end <= now; });
  const auto most = static_cast<std::size_t>(config_.commands);
  if (under_way_.empty() || under_way_.size() < most) return now;
  return *std::min_element(under_way_.begin(), under_way_.end());
}

DataTiming Dma::start(const work::Transfer& transfer) {
  check(work::is_between_l1_and_l2(transfer.direction), "the cluster's DMA reaches L1 and L2 only");
  Channel& channel = channels_[transfer.direction == work::Direction::L2ToL1 ? 0 : 1];
  const Time begin = std::max(channel.free, kernel_.now() + cycles(config_.first_data));
  if (begin > kLastTime) fail_beyond_time();
  channel.free = begin + cycles(payload_cycles(config_, transfer.bytes));
  if (config_.commands > 0) under_way_.push_back(channel.free);
  // Nobody computes during a transfer that the master waits for.
  if (transfer.background) kernel_.spawn("DMA data", disturb(begin, channel.free));
  return {begin, channel.free};
}

Process Dma::disturb(Time begin, Time end) {
  const double words = config_.bytes_per_cycle / kWordBytes;
  co_await kernel_.at(begin);
  team_.change_traffic(words);
  co_await kernel_.at(end);
  team_.change_traffic(-words);
}

}  // namespace leviosim::sim
