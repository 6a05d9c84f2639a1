// How large the compiled form of a workload is: for each named function (P::Function) the bytes of
// code that one visit of each of its pieces fetches. A function's code falls into *pieces* at its
// calls of other named functions: what runs from its entry to the first such call, and what runs
// after the return from each of them. Sizes come from compiled code (platform_models/code/), never
// from guesses.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "sim/work/compiled_work.h"

namespace leviosim::work {

/// A function's name as a number, made at compile time: a FNV-1a hash.
struct CodeName {
  static constexpr std::uint32_t kSmallest = 1u << 28;  ///< smaller numbers mean something else

  std::uint32_t key;
  const char* text = "";  ///< only of literals

  constexpr explicit CodeName(std::string_view name) : key(2166136261u) {
    for (const char c : name) key = (key ^ static_cast<unsigned char>(c)) * 16777619u;
    if (key < kSmallest) key += kSmallest;
  }
  /// From a string literal, for call sites that must not compute it.
  template <std::size_t N>
  consteval CodeName(const char (&name)[N]) : CodeName(std::string_view(name, N - 1)) {
    text = name;
  }
};

class CodeMap {
 public:
  struct Piece {
    std::uint64_t key;
    std::uint32_t bytes;        ///< distinct ones, fetched in a visit
    std::uint32_t again_bytes;  ///< fetched again in the same visit, by a loop about as large
    CompiledSets compiled{};    ///< of a visit of the whole function; of pieces after entry only
  };

  /// Adds the piece of `function` that runs after `after` has returned; after entry if that is
  /// empty. Each piece once; two names with the same hash are an internal fault.
  void add(std::string_view function, std::string_view after, std::uint32_t bytes,
           std::uint32_t again_bytes = 0, const CompiledSets& compiled = {});

  /// What a piece that is there executes as compiled for another instruction set.
  void set_compiled(int piece, CompiledFor set, const CompiledWork& compiled) {
    work::set_compiled(pieces_[static_cast<std::size_t>(piece)].compiled, set, compiled);
  }

  static constexpr std::uint64_t piece_key(std::uint32_t function, std::uint32_t after) {
    return (std::uint64_t{function} << 32) | after;
  }
  static constexpr std::uint32_t kEntry = 0;
  static constexpr int kUnknown = -1;

  /// Index of the piece, or kUnknown.
  int find(std::uint64_t key) const {
    if (table_.empty()) return kUnknown;
    for (std::size_t slot = slot_of(key);; slot = (slot + 1) & (table_.size() - 1)) {
      const int index = table_[slot];
      if (index == kUnknown || pieces_[static_cast<std::size_t>(index)].key == key) return index;
    }
  }
  const std::vector<Piece>& pieces() const { return pieces_; }

 private:
  std::size_t slot_of(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> 40) & (table_.size() - 1);
  }
  void rebuild_table();

  std::vector<Piece> pieces_;
  std::vector<int> table_;  ///< open addressing, a power of two, at most a quarter full
};

}  // namespace leviosim::work
