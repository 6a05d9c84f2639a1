// A text of which a piece is held at a time, however long it is, and its lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "sim/base/opened_file.h"

namespace leviosim::base {

class Pieces {
 public:
  explicit Pieces(std::string whole) : held_(std::move(whole)), size_(held_.size()) {}
  explicit Pieces(OpenedFile file) : size_(file.size()), file_(std::move(file)) {}

  std::uint64_t size() const { return size_; }
  /// Valid until the next call. @throws InputError if the file has become shorter
  std::string_view at(std::uint64_t begin, std::size_t size);
  /// What stands before the next line break or the end. As at()
  /// @throws InputError for a line of more than `most` bytes, of which no more is held; Interrupted
  std::string_view line_at(std::uint64_t begin, std::size_t most);
  /// How many bytes were read from the file.
  std::uint64_t bytes_read() const { return bytes_read_; }

 private:
  void hold(std::uint64_t begin, std::size_t size);
  std::string_view held_from(std::uint64_t begin) const;

  std::string held_;
  std::uint64_t begin_ = 0;  ///< of what is held
  std::uint64_t size_;
  std::uint64_t bytes_read_ = 0;
  std::optional<OpenedFile> file_;
};

}  // namespace leviosim::base
