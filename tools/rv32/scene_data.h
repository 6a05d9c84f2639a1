// What the scenes work with: sizes, numbers, machines, and inputs in memory.
#pragma once

#include <cstdint>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "sim/work/machine.h"
#include "tools/rv32/inputs.h"

namespace leviosim::rv32 {

constexpr int kWidth = 160, kHeight = 120;

/// A number that the compiler cannot know, as sizes are for code in another file.
inline int opaque(int n) {
  asm volatile("" : "+r"(n));
  return n;
}

/// Numbers in [-1, 1), the same on both sides: integers scaled by a power of two.
class Noise {
 public:
  std::uint32_t bits() {
    state_ = state_ * 1664525u + 1013904223u;
    std::uint32_t z = state_;
    z = (z ^ (z >> 16)) * 0x85ebca6bu;
    return z ^ (z >> 13);
  }
  float next() { return static_cast<float>(static_cast<std::int32_t>(bits()) >> 8) * 0x1p-23f; }

 private:
  std::uint32_t state_ = 1;
};

inline work::MachineConfig machine(std::string_view name) {
  return {.cores = 1, .memory = name, .capacity = Bytes(4 << 20), .alignment = 4, .record = false};
}

/// A block of the inputs, in `memory`.
template <class Span>
Span load(work::Arena& memory, const Inputs::Block& block) {
  using T = std::remove_pointer_t<decltype(Span().data())>;
  const Span span = memory.alloc<Span>("input", block.size<T>());
  block.copy_to(span.data(), span.size());
  return span;
}

/// Fills a pose graph with the next blocks.
template <class Graph>
void fill(Graph& graph, Inputs& inputs) {
  std::apply([&](auto&... span) { (inputs.next().copy_to(span.data(), span.size()), ...); },
             graph.blocks());
}

}  // namespace leviosim::rv32
