// The parts of a chip by which energy is reported. Together they are the chip, with its external
// memory if the workload keeps something there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace leviosim::sim {

enum class Domain : std::uint8_t { Cores, Fpu, L1, Dma, Cluster, Controller, L2, Soc, External };

struct DomainInfo {
  Domain domain;
  std::string_view name;  ///< key in statistics, title in tables
  std::string_view description;
};

inline constexpr std::array kDomains{
    DomainInfo{Domain::Cores, "cores", "instructions and leakage of the cluster's cores"},
    DomainInfo{Domain::Fpu, "fpu",
               "operations, clock and leakage of the cluster's floating-point units"},
    DomainInfo{Domain::L1, "l1", "accesses, clock and leakage of L1 with its network"},
    DomainInfo{Domain::Dma, "dma", "transfers, clock and leakage of the cluster's DMA"},
    DomainInfo{Domain::Cluster, "cluster", "clock, interconnect and leakage of the cluster"},
    DomainInfo{Domain::Controller, "controller", "fabric controller with its floating-point unit"},
    DomainInfo{Domain::L2, "l2", "accesses, clock and leakage of L2"},
    DomainInfo{Domain::Soc, "soc", "clock of the rest of the chip, leakage, regulator"},
    DomainInfo{Domain::External, "external", "transfers, refresh and standby of external memory"},
};

inline constexpr std::size_t kDomainCount = kDomains.size();

constexpr std::size_t index(Domain domain) { return static_cast<std::size_t>(domain); }

}  // namespace leviosim::sim
