#include "cuda/focused_dots/trace_rays.cuh"

namespace gladstone::cuda {

template void trace_rays(SceneView<float> const&, DeviceMedium<float> const&, TargetImage const&, Batch const&,
                         RayRecord<float>*, TraceTally*);

}  // namespace gladstone::cuda
