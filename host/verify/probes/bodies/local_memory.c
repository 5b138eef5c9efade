static void probe(Probe* p) {
    cl_ulong most = 0, used = 0;
    clGetDeviceInfo(p->device, CL_DEVICE_LOCAL_MEM_SIZE, sizeof most, &most, NULL);
    build(p, ""), prepare(p);
    clGetKernelWorkGroupInfo(p->kernel, p->device, CL_KERNEL_LOCAL_MEM_SIZE, sizeof used, &used, NULL);
    cl_uint words = (cl_uint)((most - used) / 4);
    must(p, clSetKernelArg(p->kernel, 2, words * 4, NULL), "clSetKernelArg of all local memory");
    must(p, clSetKernelArg(p->kernel, 3, sizeof words, &words), "clSetKernelArg");
    launch(p, 256, 64);
}
