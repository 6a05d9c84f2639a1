// leviosim_learn_pairs: learns the patterns of point pairs of `levio` on the synthetic flight
// (tests/support/pair_learner.h) and prints the header that holds them.
#include <fmt/core.h>

#include "tests/support/pair_learner.h"

namespace leviosim::tests {
namespace {

/// Of flights and demos (kFlightSeed).
constexpr std::uint64_t kSeed = 1;

constexpr const char* kHead =
    R"(// The 256 pairs of points that the descriptor of `levio` compares, in two patterns: learned, not
// edited by hand.
//
// Method: ORB's (Rublee et al. 2011, "Learning good binary features"). Candidates are pairs of
// points of a grid of 2 px in the disc. Each was evaluated on the first {} features of a frame each
// second of the synthetic flight (seed {}), as `levio` finds, blurs and turns them. They were ordered
// by how near the mean of their bit is to 1/2. One was taken if its bits correlate with those of
// each pair before by less than a limit. The limit rose from 0.{} until there were 256.
//
// kLearnedPairWords: as ORB, without pairs closer than the blur is wide, 5 px.
// kReleasedPairWords: without pairs that lie side by side, 2 px, only. With it there are as many
// matches as in the released program (sim/VALIDATION.md).
//
// Made by:
//     ninja -C build/release leviosim_learn_pairs
//     build/release/tests/leviosim_learn_pairs > workload/levio/vision/learned_pairs.h
#pragma once

#include "workload/vision/point_pairs.h"

namespace leviosim::vio::levio {{
)";

constexpr const char* kTail = R"(
template <class P>
inline constexpr auto kLearnedPattern = make_pair_pattern<P>(kLearnedPairWords);
template <class P>
inline constexpr auto kReleasedPattern = make_pair_pattern<P>(kReleasedPairWords);

}  // namespace leviosim::vio::levio
)";

void print_pattern(std::string_view name, const LearnedPairs& learned) {
  const vio::PairWords& words = learned.words;
  fmt::print("\n/// The limit rose to 0.{}.\ninline constexpr PairWords {} = {{", learned.limit,
             name);
  constexpr std::size_t kPerLine = 8;
  for (std::size_t k = 0; k < words.size(); ++k)
    fmt::print("{}{:#010x}{}", k % kPerLine == 0 ? "\n    " : " ", words[k],
               k + 1 < words.size() ? "," : "");
  fmt::print("}};\n");
}

void print_header() {
  const std::vector<TurnedPatch> patches = turned_patches(frames_of_flight(kSeed));
  fmt::print(kHead, LearnedPairs::kFeatures, kSeed, LearnedPairs::kFirstLimit);
  print_pattern("kLearnedPairWords", learn_pairs(patches, Candidates::FarApart));
  print_pattern("kReleasedPairWords", learn_pairs(patches, Candidates::NotSideBySide));
  fmt::print("{}", kTail);
}

}  // namespace
}  // namespace leviosim::tests

int main() { leviosim::tests::print_header(); }
