// Kinds of kernel that a chip may have an accelerator for, and how a workload marks their calls.
// What is computed inside of a mark is counted like everything else, and counted once more as work
// of that call; a chip with an accelerator takes it out of the core's work and serves the call
// instead (sim/chip/accelerator.h). The workload does not know whether there is one.
//
//   const typename P::OffloadRegion kernel(work::OffloadKind::Eigen3, 1);
//
// Marks do not nest: inside of a mark, others mean nothing. A mark lies within one work segment.
//
// Left out: the code that a kernel fetches stays with the core (code_tracker.h follows functions,
// not kernels), so an accelerated call does not save the core the misses of its instruction cache.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/work/counts.h"

namespace leviosim::work {

enum class OffloadKind : std::uint8_t { Eigen3, Eigen9, Eigen12, Corners, Hamming, Solve };

struct OffloadKindInfo {
  OffloadKind kernel;
  std::string_view name;         ///< key in platform files, statistics and work traces
  std::string_view description;  ///< what one call is
  std::string_view item;         ///< what its size is counted in
};

inline constexpr std::array kOffloadKinds = {
    OffloadKindInfo{OffloadKind::Eigen3, "eigen3", "eigenvectors of a symmetric 3x3 matrix",
                    "matrix"},
    OffloadKindInfo{OffloadKind::Eigen9, "eigen9",
                    "eigenvectors of a symmetric 9x9 matrix, all or the last", "matrix"},
    OffloadKindInfo{OffloadKind::Eigen12, "eigen12", "eigenvectors of a symmetric 12x12 matrix",
                    "matrix"},
    OffloadKindInfo{OffloadKind::Corners, "corners", "best FAST corners of a cell by Harris score",
                    "pixel"},
    OffloadKindInfo{OffloadKind::Hamming, "hamming",
                    "nearest of a list of 256-bit descriptors, for each of some",
                    "pair of descriptors"},
    OffloadKindInfo{OffloadKind::Solve, "solve",
                    "dense linear equations of n unknowns in m rows, factors included or not",
                    "m n^2 of factors, m n of substitutions"},
};
inline constexpr std::size_t kOffloadKindCount = kOffloadKinds.size();

constexpr std::size_t index(OffloadKind kernel) { return static_cast<std::size_t>(kernel); }

constexpr bool offload_kinds_are_in_order() {
  for (std::size_t i = 0; i < kOffloadKindCount; ++i)
    if (index(kOffloadKinds[i].kernel) != i) return false;
  return true;
}
static_assert(offload_kinds_are_in_order(),
              "kOffloadKinds must list every OffloadKind in its order");

/// All calls of one kind within a work segment.
struct OffloadWork {
  OffloadKind kernel{};
  std::uint64_t calls = 0;
  std::uint64_t items = 0;
  Counts counts{};  ///< also part of the counts of the segment; without code

  friend bool operator==(const OffloadWork&, const OffloadWork&) = default;
};

/// A work segment, with what of it was done in offload regions.
struct Segment : Counts {
  std::vector<OffloadWork> offload;  ///< of each kind at most one, in the order of the kinds

  Segment() = default;
  Segment(const Counts& counts) : Counts(counts) {}
  Segment(const Counts& counts, std::vector<OffloadWork> of_offload)
      : Counts(counts), offload(std::move(of_offload)) {}

  Segment& operator+=(const Segment& other);
  friend bool operator==(const Segment& a, const Segment& b) {
    return static_cast<const Counts&>(a) == static_cast<const Counts&>(b) && a.offload == b.offload;
  }
};

/// Whether the marks of this thread mean anything. A machine sets it for the time of a stage
/// (MachineConfig::offload): a run whose chip has no accelerator does not pay for marks.
inline constinit thread_local bool offload_followed = true;

/// What a mark does: the work of this thread until end_offload() is that of a call.
void begin_offload(OffloadKind kind, std::uint64_t items);
void end_offload();

/// Takes what was counted in offload regions since the last time. Before take_tally(), and not
/// within a call.
std::vector<OffloadWork> take_offload();

/// A mark, from here to the end of the scope; none if there is no kind.
template <bool Counted>
class OffloadScope {
 public:
  OffloadScope(std::optional<OffloadKind> kind, int items)
      : marked_(Counted && kind && offload_followed) {
    if constexpr (Counted)
      if (marked_) begin_offload(*kind, static_cast<std::uint64_t>(items));
  }
  ~OffloadScope() {
    if constexpr (Counted)
      if (marked_) end_offload();
  }
  OffloadScope(const OffloadScope&) = delete;
  OffloadScope& operator=(const OffloadScope&) = delete;

 private:
  bool marked_;
};

}  // namespace leviosim::work
