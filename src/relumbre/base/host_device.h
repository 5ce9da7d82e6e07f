/// Marks functions that a CUDA file may call on either side. Nothing for other compilers.
#pragma once

#if defined(__CUDACC__)
#define RELUMBRE_HOST_DEVICE __host__ __device__
#else
#define RELUMBRE_HOST_DEVICE
#endif
