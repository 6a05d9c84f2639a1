#include "sim/work/tiles.h"

namespace leviosim::work {

TilePlan plan_tiles(const Arena& arena, std::string_view block, int n, Bytes item, Bytes kept) {
  const std::int64_t room = (arena.free() - kept).count();
  const std::int64_t most = room / (2 * item.count());
  if (n > 0 && most < 1) throw arena.overflow(block, item * 2 + kept);
  if (n == 0) return {0, 0, 1, 0, 0};
  const std::int64_t tiles = (n + most - 1) / most;
  return {0, n, static_cast<int>((n + tiles - 1) / tiles), 0, n};
}

}  // namespace leviosim::work
