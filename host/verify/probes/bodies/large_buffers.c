static void probe(Probe* p) {
    const cl_ulong size = 4500000000u;
    cl_ulong most = 0, memory = 0;
    clGetDeviceInfo(p->device, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof most, &most, NULL);
    clGetDeviceInfo(p->device, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof memory, &memory, NULL);
    if (most < size || memory < size * 3 / 2) return (void)(p->lacks = "buffers over 4 GB");
    build(p, ""), prepare(p);
    p->buffers[2] = clCreateBuffer(p->context, CL_MEM_READ_WRITE, size, NULL, NULL);
    must(p, clSetKernelArg(p->kernel, 2, sizeof(cl_mem), &p->buffers[2]), "clSetKernelArg of a buffer over 4 GB");
    launch(p, 64, 64);
    for (cl_uint i = 0, found = 0; i < 64; ++i) {  // the kernel wrote i to byte 70,000,000 i
        const size_t at = (size_t)70000000 * i;
        must(p, clEnqueueReadBuffer(p->queue, p->buffers[2], CL_TRUE, at, 4, &found, 0, NULL, NULL), "read");
        expect(p, found == i, "the first wrong block of 70,000,000 bytes", i);
    }
}
