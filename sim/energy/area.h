// What a chip occupies, part by part, with bands: the sums over the numbers of its section `area`
// (sim/chip/config.h) and of what it has.
//
// Models: logic by gate equivalents; a memory block as a constant and so much a bit; the networks
// of L1, L2, the shared instruction cache and the floating-point units by masters times slaves;
// caches with their tags and ways, of latches or a memory block, whichever is smaller; DMA and bus
// by their widths. A shared cache that answers faster than its structure lets it comes as copies
// for the cores. A band is the root of the sum of squares over the numbers, which are independent
// of each other.
//
// Leaves out: pads, supplies, clock generators, analogue parts and non-volatile memory; that a
// network grows faster where clocks are high, and that a larger chip has more wires.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "sim/chip/area_config.h"
#include "sim/chip/config.h"
#include "sim/energy/domain.h"

namespace leviosim::sim {

/// A kind of part, all of that kind together.
struct AreaItem {
  std::string name;
  Domain domain;
  double count = 0;
  /// Logic, and memories as so much logic as would have their area; none of L1's and L2's banks.
  KiloGates gates;
  SquareMicrometres area;
  SquareMicrometres low;
  SquareMicrometres high;
  bool known = true;  ///< whether there is a figure; without one it counts as nothing
};

/// Whether the platform has areas.
bool knows_area(const ChipConfig& chip);

/// What the chip has, and the cluster's workers, used or not. The chip must have areas.
std::vector<AreaItem> areas_of(const ChipConfig& chip);

/// Whether a domain is in the cluster.
bool is_of_cluster(Domain domain);

/// The sums, with their bands.
AreaItem cluster_area(const ChipConfig& chip);
AreaItem total_area(const ChipConfig& chip);

/// Logic of each domain, with memories that are no banks of L1 or L2; none where no areas are
/// known. Without bands: what a gate leaks and what its clock takes was fitted to these values.
using GatesByDomain = std::array<KiloGates, kDomainCount>;
GatesByDomain gates_by_domain(const ChipConfig& chip);

/// Memory blocks of L2.
double l2_cuts(const ChipConfig& chip);

}  // namespace leviosim::sim
