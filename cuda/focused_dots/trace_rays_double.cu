#include "cuda/focused_dots/trace_rays.cuh"

namespace gladstone::cuda {

template void trace_rays(SceneView<double> const&, DeviceMedium<double> const&, TargetImage const&, Batch const&,
                         RayRecord<double>*, TraceTally*);

}  // namespace gladstone::cuda
