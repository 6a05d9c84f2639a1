#include "sim/work/code_tracker.h"

#include <algorithm>

namespace leviosim::work {

void CodeTracker::visit(std::uint64_t key) {
  const int piece = map_->find(key);
  if (piece == CodeMap::kUnknown) return;
  const CodeMap::Piece& code = map_->pieces()[static_cast<std::size_t>(piece)];
  const std::uint32_t bytes = code.bytes;
  std::uint32_t distance = bytes;
  std::size_t i = 0;
  for (; i < recent_.size() && recent_[i].piece != piece; ++i) distance += recent_[i].bytes;
  const bool known = i < recent_.size();
  if (!known) recent_.push_back({piece, bytes});
  std::move_backward(recent_.begin(), recent_.begin() + static_cast<std::ptrdiff_t>(i),
                     recent_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  recent_.front() = {piece, bytes};
  tally.code[known ? reuse_class(distance) : kNeverFetched] += bytes;
  if (code.again_bytes > 0) tally.code[reuse_class(bytes)] += code.again_bytes;
}

}  // namespace leviosim::work
