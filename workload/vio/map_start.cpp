#include "workload/vio/map_start.h"

#include "workload/vio/keyframe_insertion.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {

template <class P>
void start_map(FrontEndState<P>& state, Frame<P>& frame) {
  using Floats = typename P::template Span<typename P::F32>;
  work::Arena& local = state.machine.local();
  const work::Arena::Frame memory(local);
  const auto stage = state.machine.stage(stages::kTriangulation);
  const auto record = local.alloc<Floats>("IMU interval", Preintegration<P>::kFloats);
  state.machine.copy_in(record, state.keyframe.interval);
  frame.T_world_camera = Pose<P>::identity();
  const Vec3<P> force = load_vec3<P>(record, 0);
  const bool upright = state.profile.optimiser.joint;
  if (upright) frame.T_world_camera.R = upright_rotation<P>(force);
  const Vec3<P> gravity = upright ? Vec3<P>{0.0f, 0.0f, -kGravity}
                                  : gravity_from_force<P>(force, frame.T_world_camera.R);
  begin_map<P>(state, frame, record, ImuBias<P>::zero(), gravity);
}

template <class P>
void begin_map(FrontEndState<P>& state, const Frame<P>& frame,
               typename P::template Span<typename P::F32> record, const ImuBias<P>& bias,
               const Vec3<P>& gravity) {
  const auto& graph = state.graph_in_l2;
  if (state.started)
    graph.restart(bias, gravity);
  else
    graph.clear(bias, gravity);
  graph.set_bias_prior(BiasPrior<P>::unknown(state.profile.biases));
  Preintegration<P>(record).reset(bias);
  graph.add_keyframe({frame.T_world_camera, {0.0f, 0.0f, 0.0f}}, record);
  state.machine.copy_out(state.keyframe.interval, record);
  store_keyframe<P>(state, frame);
  state.started = true;
}

template void start_map(FrontEndState<work::Native>&, Frame<work::Native>&);
template void start_map(FrontEndState<work::Counting>&, Frame<work::Counting>&);
template void begin_map(FrontEndState<work::Native>&, const Frame<work::Native>&,
                        work::Native::Span<float>, const ImuBias<work::Native>&,
                        const Vec3<work::Native>&);
template void begin_map(FrontEndState<work::Counting>&, const Frame<work::Counting>&,
                        work::Counting::Span<work::F32>, const ImuBias<work::Counting>&,
                        const Vec3<work::Counting>&);

}  // namespace leviosim::vio
