#include "sim/work/offload_regions.h"

#include <algorithm>
#include <memory>
#include <new>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/threads.h"

namespace leviosim::work {
namespace {

struct OffloadTally {
  struct Sum {
    std::uint64_t calls = 0;
    std::uint64_t items = 0;
    RawCounts counts{};
  };
  std::array<Sum, kOffloadKindCount> sums{};
  RawCounts at_begin{};  ///< the tally when the present call began
  OffloadKind present{};
  int depth = 0;  ///< of marks within marks
  bool any = false;
};

/// That of the host's thread, as the tally is. Made when it is needed, since what a module of
/// Python holds for each thread has to fit into 1.5 kB that the C library leaves for all modules.
OffloadTally& of_this_thread() {
  static constinit thread_local OffloadTally* held = nullptr;
  if (held != nullptr) return *held;
  static const base::AtThreadEnd at_thread_end([](void* ended) {
    delete static_cast<OffloadTally*>(ended);
    held = nullptr;
  });
  auto made = std::make_unique<OffloadTally>();
  if (!at_thread_end.set(made.get())) throw std::bad_alloc();
  return *(held = made.release());
}

}  // namespace

void begin_offload(OffloadKind kind, std::uint64_t items) {
  OffloadTally& t = of_this_thread();
  if (t.depth++ > 0) return;
  t.present = kind;
  t.any = true;
  OffloadTally::Sum& sum = t.sums[index(kind)];
  ++sum.calls;
  sum.items += items;
  t.at_begin = {tally.n, branches_not_taken_after_all};
}

void end_offload() {
  OffloadTally& t = of_this_thread();
  if (--t.depth > 0) return;
  RawCounts& sum = t.sums[index(t.present)].counts;
  for (std::size_t i = 0; i < kOpCount; ++i) sum.n[i] += tally.n[i] - t.at_begin.n[i];
  sum.not_taken_after_all += branches_not_taken_after_all - t.at_begin.not_taken_after_all;
}

std::vector<OffloadWork> take_offload() {
  OffloadTally& t = of_this_thread();
  if (!t.any) return {};
  check_equal(t.depth, 0, "offload regions that go on at the end of a work segment");
  std::vector<OffloadWork> taken;
  for (const OffloadKindInfo& info : kOffloadKinds) {
    OffloadTally::Sum& sum = t.sums[index(info.kernel)];
    if (sum.calls == 0) continue;
    taken.push_back({info.kernel, sum.calls, sum.items, settled(sum.counts)});
    sum = {};
  }
  t.any = false;
  return taken;
}

Segment& Segment::operator+=(const Segment& other) {
  Counts::operator+=(other);
  for (const OffloadWork& more : other.offload) {
    const auto at = std::find_if(offload.begin(), offload.end(), [&](const OffloadWork& k) {
      return index(k.kernel) >= index(more.kernel);
    });
    if (at == offload.end() || at->kernel != more.kernel) {
      offload.insert(at, more);
      continue;
    }
    at->calls += more.calls;
    at->items += more.items;
    at->counts += more.counts;
  }
  return *this;
}

}  // namespace leviosim::work
