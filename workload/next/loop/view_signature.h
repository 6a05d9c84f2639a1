// The signature of a view: a bag of binary words that needs no trained vocabulary. A word is one of
// four bytes of a descriptor; the signature has a bit for each of the 4 × 256 words, set if a
// feature of the view has it. A byte stays the same if none of its bits flips, so views of one
// place share more words than chance. It ranks places; it never decides.
#pragma once

namespace leviosim::vio {

inline constexpr int kSignatureTables = 4;
inline constexpr int kSignatureWords = 8 * kSignatureTables;

/// Adds the words of a descriptor (8 words).
template <class P, class Words>
void add_to_signature(const Words& descriptor,
                      typename P::template Span<typename P::U32> signature) {
  using U32 = typename P::U32;
  using I32 = typename P::I32;
  for (int table = 0; table < kSignatureTables; ++table) {
    const U32 word = descriptor[2 * table];
    const I32 at = I32((word >> 5) & U32(7u)) + I32(8 * table);
    const U32 bit = U32(1u) << I32(word & U32(31u));
    signature[at] = U32(signature[at]) | bit;
  }
}

/// Twice the shared words in 1000 of all words of both, 0 … 1000.
template <class P, class A, class B>
typename P::I32 similarity(const A& a, const B& b) {
  using U32 = typename P::U32;
  using I32 = typename P::I32;
  I32 shared = 0, all = 0;
  for (int w : P::range(0, kSignatureWords)) {
    const U32 x = a[w], y = b[w];
    shared += work::popcount(x & y);
    all += work::popcount(x) + work::popcount(y);
  }
  if (all == I32(0)) return I32(0);
  return I32(shared * I32(2000)) / all;
}

}  // namespace leviosim::vio
