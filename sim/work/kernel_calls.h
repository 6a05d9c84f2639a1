// Kinds of kernel that a chip may have an accelerator for, and how a workload marks their calls.
// What is computed inside of a mark is counted like everything else, and counted once more as work
// of that call; a chip with an accelerator takes it out of the core's work and serves the call
// instead (sim/chip/accelerator.h). The workload does not know whether there is one.
//
//   const typename P::Kernel kernel(work::KernelKind::Eigen3, 1);
//
// Marks do not nest: inside of a mark, others mean nothing. A mark lies within one piece of work.
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

enum class KernelKind : std::uint8_t { Eigen3, Eigen9, Eigen12, Corners, Hamming, Solve };

struct KernelInfo {
  KernelKind kernel;
  std::string_view name;         ///< key in platform files, statistics and work traces
  std::string_view description;  ///< what one call is
  std::string_view item;         ///< what its size is counted in
};

inline constexpr std::array kKernels = {
    KernelInfo{KernelKind::Eigen3, "eigen3", "eigenvectors of a symmetric 3x3 matrix", "matrix"},
    KernelInfo{KernelKind::Eigen9, "eigen9",
               "eigenvectors of a symmetric 9x9 matrix, all or the last", "matrix"},
    KernelInfo{KernelKind::Eigen12, "eigen12", "eigenvectors of a symmetric 12x12 matrix",
               "matrix"},
    KernelInfo{KernelKind::Corners, "corners", "best FAST corners of a cell by Harris score",
               "pixel"},
    KernelInfo{KernelKind::Hamming, "hamming",
               "nearest of a list of 256-bit descriptors, for each of some", "pair of descriptors"},
    KernelInfo{KernelKind::Solve, "solve",
               "dense linear equations of n unknowns in m rows, factors included or not",
               "m n^2 of factors, m n of substitutions"},
};
inline constexpr std::size_t kKernelCount = kKernels.size();

constexpr std::size_t index(KernelKind kernel) { return static_cast<std::size_t>(kernel); }

constexpr bool kernels_are_in_order() {
  for (std::size_t i = 0; i < kKernelCount; ++i)
    if (index(kKernels[i].kernel) != i) return false;
  return true;
}
static_assert(kernels_are_in_order(), "kKernels must list every KernelKind in its order");

/// All calls of one kind within a piece of work.
struct KernelWork {
  KernelKind kernel{};
  std::uint64_t calls = 0;
  std::uint64_t items = 0;
  Counts counts{};  ///< also part of the counts of the piece; without code

  friend bool operator==(const KernelWork&, const KernelWork&) = default;
};

/// A piece of work, with what of it was done in calls of kernels.
struct Piece : Counts {
  std::vector<KernelWork> kernels;  ///< of each kind at most one, in the order of the kinds

  Piece() = default;
  Piece(const Counts& counts) : Counts(counts) {}
  Piece(const Counts& counts, std::vector<KernelWork> of_kernels)
      : Counts(counts), kernels(std::move(of_kernels)) {}

  Piece& operator+=(const Piece& other);
  friend bool operator==(const Piece& a, const Piece& b) {
    return static_cast<const Counts&>(a) == static_cast<const Counts&>(b) && a.kernels == b.kernels;
  }
};

/// Whether the marks of this thread mean anything. A machine sets it for the time of a stage
/// (MachineConfig::kernels): a run whose chip has no accelerator does not pay for marks.
inline constinit thread_local bool kernels_followed = true;

/// What a mark does: the work of this thread until end_kernel() is that of a call.
void begin_kernel(KernelKind kind, std::uint64_t items);
void end_kernel();

/// Takes what was counted in calls of kernels since the last time. Before take_tally(), and not
/// within a call.
std::vector<KernelWork> take_kernels();

/// A mark, from here to the end of the scope; none if there is no kind.
template <bool Counted>
class KernelScope {
 public:
  KernelScope(std::optional<KernelKind> kind, int items)
      : marked_(Counted && kind && kernels_followed) {
    if constexpr (Counted)
      if (marked_) begin_kernel(*kind, static_cast<std::uint64_t>(items));
  }
  ~KernelScope() {
    if constexpr (Counted)
      if (marked_) end_kernel();
  }
  KernelScope(const KernelScope&) = delete;
  KernelScope& operator=(const KernelScope&) = delete;

 private:
  bool marked_;
};

}  // namespace leviosim::work
