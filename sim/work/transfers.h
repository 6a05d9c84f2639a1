// How much a work segment moved between memories.
#pragma once

#include <cstdint>

#include "sim/work/program.h"

namespace leviosim::work {

/// A plain value: add two to merge two work segments.
struct Transferred {
  std::int64_t transfers = 0;  ///< between L1 and L2
  Bytes bytes;                 ///< of these, both directions
  Bytes external;              ///< between L2 and external memory
  std::int64_t tiles = 0;      ///< of all these, in the background: what passes in tiles
  Bytes tile_bytes{0};
  Bytes tile_bytes_more{0};  ///< of these, what would not move with room for the whole blocks

  Transferred& operator+=(const Transferred& o) {
    transfers += o.transfers;
    bytes += o.bytes;
    external += o.external;
    tiles += o.tiles;
    tile_bytes += o.tile_bytes;
    tile_bytes_more += o.tile_bytes_more;
    return *this;
  }
};

/// All transfers of a stage.
inline Transferred transferred_by(const StageRun& stage) {
  Transferred sum;
  for (const Step& step : stage.steps) {
    const auto* transfer = std::get_if<Transfer>(&step);
    if (transfer == nullptr) continue;
    if (transfer->background) {
      ++sum.tiles;
      sum.tile_bytes += transfer->bytes;
      sum.tile_bytes_more += transfer->more;
    }
    if (is_between_l1_and_l2(transfer->direction)) {
      ++sum.transfers;
      sum.bytes += transfer->bytes;
    } else {
      sum.external += transfer->bytes;
    }
  }
  return sum;
}

}  // namespace leviosim::work
