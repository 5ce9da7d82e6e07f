# The GPU sides of the modules in src/relumbre, lowest first.
relumbre_cuda_module(cuda HOST base)
relumbre_cuda_module(scan DEPENDS cuda)
relumbre_cuda_module(sat DEPENDS scan)
relumbre_cuda_module(dof DEPENDS sat)
relumbre_cuda_module(octree DEPENDS cuda)
relumbre_cuda_module(visibility DEPENDS cuda)
relumbre_cuda_module(radiosity DEPENDS visibility scan LINK CUDA::cublas FULL relight_operator_cuda.cu)
