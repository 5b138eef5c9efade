static void probe(Probe* p) {
    cl_uint align = 0;
    build(p, ""), prepare(p);
    clGetDeviceInfo(p->device, CL_DEVICE_MEM_BASE_ADDR_ALIGN, sizeof align, &align, NULL);
    const size_t part = align / 8 < 1024 ? 1024 : align / 8;  // of a buffer of 256 kB, in bytes
    for (size_t from = 0; from + part <= sizeof p->words && from < 20 * part; from += part) {
        const cl_buffer_region region = {from, part};
        const cl_uint first = (cl_uint)(from / 4);
        p->buffers[2] = clCreateSubBuffer(p->buffers[0], 0, CL_BUFFER_CREATE_TYPE_REGION, &region, NULL);
        must(p, clSetKernelArg(p->kernel, 2, sizeof(cl_mem), &p->buffers[2]), "clSetKernelArg of a part");
        must(p, clSetKernelArg(p->kernel, 3, sizeof first, &first), "clSetKernelArg");
        launch(p, part / 4, 64);
        clReleaseMemObject(p->buffers[2]), p->buffers[2] = NULL;
    }
}
