// A workload of another project. Once it is added, --profile NAME runs it, and every command that
// runs, records or varies a workload does so with this one (tests/examples/outside).
#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "platform_models/loader/compiled_code.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_source.h"
#include "workload/vio/odometry/odometry.h"
#include "workload/vio/parameters.h"
#include "workload/vio/records.h"

namespace leviosim {

namespace work {
class Machine;
}

/// What a run does with each frame: computes it on the cluster's machine, and may fill in the pose
/// (else the body stays at the origin) and what else there is to say about the frame.
using FrameFunction =
    std::function<void(work::Machine&, const vio::FrameInput&, tools::FrameResult&)>;

struct Workload : vio::OtherProfile {
  /// Begins a run: the images of the request's data, prepared as for the odometry, come frame by
  /// frame.
  std::function<FrameFunction(const tools::RunRequest&)> begin;
  /// Instead of `begin`, for other data or work on the controller: everything that a run asks for.
  std::function<std::unique_ptr<tools::RunSource>(const tools::RunRequest&)> source = {};
  /// Its kernels as compiled code: what leviosim-measure wrote.
  std::vector<platform::CodeTable> code = {};
};

/// Cycles of the chip's cluster for one job, from the controller's call to its return: what `body`
/// does on the machine that it gets, within stages. @param cores  0: as many as the chip's cluster
/// works with
Cycles cycles_on(const platform::ResolvedPlatform& chip,
                 const std::function<void(work::Machine&)>& body, int cores = 0);

namespace tools {

/// Before any command. Results of this program are found again only by the same program, since its
/// code is part of them. @throws InputError as vio::add_profile()
void add_workload(Workload workload);

/// The work that the request asks for: that of the odometry, or of the workload whose name is its
/// profile's. @param request  outlives the source
std::unique_ptr<RunSource> make_source(const RunRequest& request);

/// What a parameter of the workload is in a run, set or not.
double value_of(const RunRequest& request, const vio::Parameter& parameter);
/// The same by name, which must be known: "workload.window".
double value_of(const RunRequest& request, std::string_view parameter);

/// The values of all parameters, in the order of vio::parameters().
std::vector<double> parameter_values(const RunRequest& request);

/// The stages of such a run, as far as they are known before.
std::vector<vio::StageName> stages_of(const RunRequest& request);

}  // namespace tools
}  // namespace leviosim
