// Identity of this build in manifests and caches.
#pragma once

#include <string>
#include <string_view>

namespace leviosim::tools {

/// Of the project, "0.1.0".
std::string_view version();

/// The git commit that was checked out when the build was configured; empty outside a repository.
std::string_view revision();

/// Digest of the sources that make the synthetic flight: another digest, another flight.
std::string_view flight_version();

/// Digest of the sources that decide the results of runs and replays: finished ones of another
/// digest are no cache hits.
std::string_view results_version();

/// From now on results_version() depends on this digest of a program, too, which has a workload of
/// its own. Before anything asks for it.
void include_own_code(const std::string& digest);

/// results_version() of leviosim itself.
std::string_view results_sources();

}  // namespace leviosim::tools
