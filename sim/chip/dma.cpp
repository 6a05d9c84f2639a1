#include "sim/chip/dma.h"

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/events/last_time.h"

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

void Traffic::add(const Interval& data) {
  if (data_.size() == kMostUnderWay)
    throw InputError(
        "the work has more transfers under way at once than the simulation can follow, 4096: it "
        "begins too many background transfers without waiting for them");
  data_.push_back(data);
}

void Traffic::forget(Cycles before) {
  std::erase_if(data_, [&](const Interval& data) { return data.end <= before; });
}

double Traffic::words(Cycles now) const {
  double words = 0;
  for (const Interval& data : data_) words += data.begin <= now && now < data.end ? words_ : 0;
  return words;
}

Cycles Traffic::next_change(Cycles now) const {
  Cycles next = kNever;
  for (const Interval& data : data_)
    for (const Cycles change : {data.begin, data.end})
      if (change > now) next = std::min(next, change);
  return next;
}

Dma::Dma(const DmaConfig& config)
    : config_(config), traffic_(config.bytes_per_cycle / kWordBytes) {}

void Dma::begin_job() {
  traffic_.forget(Traffic::kNever);
  free_ = {};
  under_way_.clear();
}

Cycles Dma::room(Cycles now) {
  std::erase_if(under_way_, [&](Cycles end) { return end <= now; });
  const auto most = static_cast<std::size_t>(config_.commands);
  if (under_way_.empty() || under_way_.size() < most) return now;
  return *std::min_element(under_way_.begin(), under_way_.end());
}

Interval Dma::start(const work::Transfer& transfer, Cycles now) {
  check(work::is_between_l1_and_l2(transfer.direction), "the cluster's DMA reaches L1 and L2 only");
  Cycles& free = free_[transfer.direction == work::Direction::L2ToL1 ? 0 : 1];
  const Cycles begin = std::max(free, later(now, counted_cycles(std::round(config_.first_data))));
  free = later(begin, counted_cycles(std::round(payload_cycles(config_, transfer.bytes))));
  if (config_.commands > 0) under_way_.push_back(free);
  if (transfer.background) {
    traffic_.forget(now);
    traffic_.add({begin, free});
  }
  return {begin, free};
}

}  // namespace leviosim::sim
