#include "sim/work/arena.h"

#include <fmt/format.h>

#include "sim/base/check.h"

namespace leviosim::work {
namespace {

constexpr std::int64_t kHostAlignment = 8;

std::int64_t round_up(std::int64_t n, std::int64_t to) { return (n + to - 1) / to * to; }

// Host blocks are padded to kHostAlignment while modelled ones may be packed; small blocks can need
// several times their size, so the host gets twice the capacity and room for a thousand blocks.
Bytes host_capacity_for(Bytes capacity) { return capacity * 2 + Bytes(1024 * kHostAlignment); }

}  // namespace

Arena::Arena(std::string_view name, Bytes capacity, int alignment)
    : name_(name),
      capacity_(capacity),
      alignment_(alignment),
      host_capacity_(host_capacity_for(capacity)) {}

Arena::Arena(const Arena& lender, std::string_view name, Bytes offset, Bytes capacity,
             Bytes host_offset, Bytes host_capacity)
    : name_(name),
      user_(lender.user_),
      capacity_(capacity),
      alignment_(lender.alignment_),
      base_(offset),
      storage_(lender.storage_ + host_offset.count()),
      host_capacity_(host_capacity) {}

Bytes Arena::place(std::string_view name, Bytes size) {
  const Bytes offset(round_up((base_ + used_).count(), alignment_));
  const Bytes end = offset - base_ + size;
  if (end > capacity_) throw overflow(name, size);
  live_.push_back({name, offset, size});
  used_ = end;
  if (used_ > peak_) {
    peak_ = used_;
    at_peak_ = live_;
  }
  return offset;
}

MemoryOverflow Arena::overflow(std::string_view block, Bytes size) const {
  const Bytes begin(round_up((base_ + used_).count(), alignment_));
  const Bytes missing = begin - base_ + size - capacity_;
  return MemoryOverflow(
      fmt::format("{}: block '{}' of {} bytes does not fit in {}: {} of {} bytes are in use, {} "
                  "bytes are missing",
                  user_.empty() ? "set-up" : user_, block, size.count(), name_, used_.count(),
                  capacity_.count(), missing.count()),
      std::string(name_), missing);
}

std::byte* Arena::host(Bytes size) {
  const Bytes begin = host_used_;
  host_used_ += Bytes(round_up(size.count(), kHostAlignment));
  check(host_used_ <= host_capacity_,
        "an arena's host storage is exhausted before its modelled memory");
  return storage() + begin.count();
}

std::byte* Arena::storage() {
  if (storage_ == nullptr) {
    owned_.reset(new std::byte[static_cast<std::size_t>(host_capacity_.count())]);
    storage_ = owned_.get();
  }
  return storage_;
}

void Arena::reset_peak() {
  peak_ = used_;
  at_peak_ = live_;
}

Arena Arena::lend(std::string_view name, int n, int k) {
  storage();
  const Bytes each(free().count() / n / alignment_ * alignment_);
  const Bytes host_each((host_capacity_ - host_used_).count() / n / kHostAlignment *
                        kHostAlignment);
  return Arena(*this, name, base_ + used_ + each * k, each, host_used_ + host_each * k, host_each);
}

}  // namespace leviosim::work
