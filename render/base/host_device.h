#pragma once

/// Marks a function that runs on the host and, when compiled by nvcc, on a CUDA device.
#if defined(__CUDACC__)
#define GLADSTONE_HD __host__ __device__
#else
#define GLADSTONE_HD
#endif
