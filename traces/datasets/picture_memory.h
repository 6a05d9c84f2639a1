// Prepared pictures that several runs over the same frames share, so that each is decoded once.
// Pictures are kept until the memory is full; further ones are read each time. What is kept does
// not change with the number of threads that ask, only who decodes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace leviosim::traces {

class PictureMemory {
 public:
  using Pixels = std::vector<std::uint8_t>;

  /// 3 400 pictures of 160x120.
  static constexpr std::size_t kMostBytes = std::size_t{64} << 20;

  explicit PictureMemory(std::size_t most_bytes = kMostBytes) : most_(most_bytes) {}

  /// @param name  of the file and of what was made of it
  std::optional<Pixels> find(const std::string& name) const;
  void keep(const std::string& name, const Pixels& pixels);

 private:
  std::size_t most_;
  std::size_t bytes_ = 0;
  std::unordered_map<std::string, Pixels> pictures_;
  mutable std::mutex lock_;
};

}  // namespace leviosim::traces
