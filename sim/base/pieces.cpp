#include "sim/base/pieces.h"

#include <fmt/core.h>

#include <algorithm>

#include "sim/base/error.h"
#include "sim/base/interruption.h"

namespace leviosim::base {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18;

}  // namespace

std::string_view Pieces::held_from(std::uint64_t begin) const {
  if (begin < begin_ || begin > begin_ + held_.size()) return {};
  return std::string_view(held_).substr(begin - begin_);
}

void Pieces::hold(std::uint64_t begin, std::size_t size) {
  throw_if_interrupted();
  held_.resize(size);
  begin_ = begin;
  bytes_read_ += size;
  file_->read_piece(begin, held_);
}

std::string_view Pieces::at(std::uint64_t begin, std::size_t size) {
  if (held_from(begin).size() < size) {
    // Lines are read one after the other, forwards or backwards: what comes next is held, too.
    const std::uint64_t end = begin + size;
    const std::uint64_t from =
        begin < begin_ && end > kPiece ? std::min(begin, end - kPiece) : begin;
    hold(from, std::min<std::uint64_t>(std::max<std::uint64_t>(kPiece, end - from), size_ - from));
  }
  return held_from(begin).substr(0, size);
}

std::string_view Pieces::line_at(std::uint64_t begin, std::size_t most) {
  for (std::size_t piece = kPiece;; piece *= 2) {
    const std::string_view rest = held_from(begin);
    const std::size_t end = rest.find('\n');
    const bool is_whole = end != std::string_view::npos || begin + rest.size() == size_;
    const std::string_view line = rest.substr(0, end);
    if (line.size() > most)
      throw InputError(fmt::format("{}: the line that begins at byte {} has more than {} bytes",
                                   file_ ? file_->path().string() : std::string("text"), begin,
                                   most));
    if (is_whole) return line;
    hold(begin, std::min<std::uint64_t>(piece, size_ - begin));
  }
}

}  // namespace leviosim::base
