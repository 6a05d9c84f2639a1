// Reads the blocks that tests/bench/rv32_inputs.cpp wrote.
#pragma once

#include <cstdint>
#include <cstring>

namespace leviosim::rv32 {

class Inputs {
 public:
  explicit Inputs(const unsigned char* at) : at_(at) {}

  /// The next block, as elements of T in memory of the caller's.
  struct Block {
    const unsigned char* data;
    int bytes;

    template <class T>
    int size() const {
      return bytes / static_cast<int>(sizeof(T));
    }
    template <class T>
    void copy_to(T* to, int n) const {
      std::memcpy(static_cast<void*>(to), data, static_cast<std::size_t>(n) * sizeof(T));
    }
    float real(int i) const {
      float x;
      std::memcpy(&x, data + 4 * i, sizeof x);
      return x;
    }
  };
  Block next() {
    std::uint32_t bytes;
    std::memcpy(&bytes, at_, sizeof bytes);
    const Block block{at_ + 4, static_cast<int>(bytes)};
    at_ += 4 + (bytes + 3) / 4 * 4;
    return block;
  }

 private:
  const unsigned char* at_;
};

}  // namespace leviosim::rv32
